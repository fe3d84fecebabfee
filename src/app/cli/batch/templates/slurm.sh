#!/bin/sh
# sbatch this; then: sbatch --dependency=singleton --job-name=linden --wrap=@merge_sh@
#SBATCH --job-name=linden
#SBATCH --array=0-@last@
#SBATCH --cpus-per-task=1
#SBATCH --output=linden-%a.log
export RAYON_NUM_THREADS="${SLURM_CPUS_PER_TASK:-1}"
exec linden batch @manifest_sh@ --out @out_sh@ --shard "$SLURM_ARRAY_TASK_ID/@shards@" --resume
