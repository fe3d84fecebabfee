#!/bin/sh
# Run it again after a failure: it tries again what failed, and what is there is left out.
export RAYON_NUM_THREADS=1
seq 0 @last@ | parallel --joblog linden.log --resume-failed \
    linden batch @manifest_twice@ --out @out_twice@ --shard '{}/@shards@' --resume &&
linden batch @manifest_sh@ --out @out_sh@ --merge
