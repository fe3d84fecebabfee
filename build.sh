cd /tmp/w2; export LINDEN_COMMIT= CARGO_INCREMENTAL=0 CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 CARGO_TARGET_DIR=/tmp/sct
(time nice -n 8 cargo build --release -q -p linden-cli -j1) > /tmp/w2.log 2>&1; date > /tmp/w2.done
