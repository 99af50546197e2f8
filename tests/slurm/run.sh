#!/usr/bin/env bash
# Renders a plan on a real Slurm: tests/slurm/run.sh [PROGRAM], by default target/release/weekender. Needs Debian's packages
# slurm-wlm and munge; starts a cluster of its own in a temporary directory and removes it. Without the packages it says
# that nothing was tested, or fails where WEEKENDER_REQUIRE_SLURM=1 is set.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
PATH=$PATH:/usr/sbin:/sbin
# shellcheck source=tests/slurm/cluster.sh
. "$here/cluster.sh"

said() { printf '%5s s  %s\n' "$SECONDS" "$*"; }
fail() {
    printf 'FAILED: %s\n' "$*" >&2
    exit 1
}

tool=$(missing_tool)
if [ -n "$tool" ]; then
    [ "${WEEKENDER_REQUIRE_SLURM:-}" != 1 ] || fail "there is no $tool: install slurm-wlm and munge"
    echo "NOT TESTED: the plan on Slurm; there is no $tool (install slurm-wlm and munge)" >&2
    exit 0
fi
program=$(realpath -e "${1:-$here/../../target/release/weekender}") || fail "build the program first"

work=$(mktemp -d)
# munged wants its directory and those above to be open to all.
chmod 755 "$work"
cleaned_up() {
    local code=$?
    trap - EXIT
    trap : INT TERM HUP
    if [ "$code" -ne 0 ]; then
        tail -n 30 "$work"/cluster/log/*.log "$work"/plan/*.log "$work"/*.log 2> /dev/null || true
    fi >&2
    set +e
    cluster_down "$work/cluster" || code=1
    rm -rf "$work"
    exit "$code"
}
trap cleaned_up EXIT
trap 'printf "FAILED: line %s: %s\n" "$LINENO" "$BASH_COMMAND" >&2' ERR
trap 'exit 130' INT
trap 'exit 143' TERM
trap 'exit 129' HUP

# Different levels of the processor, of those that round alike, and different widths. One level is enough.
levels=()
for isa in avx512 avx2 neon; do
    if "$program" --batch --size 8x8 --samples 1 --device cpu --isa "$isa" --out "$work/try.png" > /dev/null 2>&1; then
        levels+=("--isa=$isa")
    fi
done
[ "${#levels[@]}" -gt 0 ] || levels=("--isa=auto")
slow="${levels[0]} --simd=off"
levels+=("${levels[-1]} --simd=4")

# Parts that are to be ended early have one lane when they first start: that takes seconds, and the film must not show it.
ended=(1 2 3)
touch "${ended[@]/#/$work/to-be-ended-}"
cat > "$work/weekender" << END
#!/usr/bin/env bash
# The program of this cluster, whose nodes have different processors.
if [ "\$1" != render-part ]; then exec "$program" "\$@"; fi
levels=($(printf '"%s" ' "${levels[@]}"))
level=\${levels[SLURM_ARRAY_TASK_ID % ${#levels[@]}]}
if [ -e "$work/to-be-ended-\$SLURM_ARRAY_TASK_ID" ]; then level="$slow"; fi
echo "\$SLURM_ARRAY_TASK_ID \$\$ \$level" >> "$work/starts.log"
exec "$program" "\$@" \$level
END
chmod +x "$work/weekender"

cluster_up "$work/cluster" 4
said "$(sinfo --version), munge: one node with 4 slots is idle"

cd "$work"
picture=(--scene book --size 160x90 --device cpu --samples 16384)
start=$("$program" plan "${picture[@]}" --threads 1 --parts 8 --every 0.1s --format slurm --program "$work/weekender" \
    --out plan 2> plan.log)
[ "$start" = "sh plan/submit.sh" ] || fail "plan prints: $start"

# Submits the plan. Sets the numbers of the array and of the job that merges.
submitted() {
    local told
    told=$(sh plan/submit.sh --partition=test --time=10)
    merge_job=${told##* }
    array=$(squeue --noheader --states=all --name=weekender --format=%F | sort -nu | tail -n 1)
    [[ "$merge_job $array" =~ ^[0-9]+\ [0-9]+$ ]] || fail "submit.sh prints: $told; the array is: $array"
}
# What Slurm says about a job, such as JobState.
field() { scontrol show job "$1" --oneliner | sed -nE "s/^(.* )?$2=([^ ]*).*/\2/p"; }
has_ended() {
    local left
    left=$(squeue --noheader --job="$1" 2> /dev/null) && [ -z "$left" ]
}
has_state() { [ "$(field "$1" JobState)" = "$2" ]; }
was_queued_again() { [ "$(field "$1" Restarts)" = 1 ]; }
samples_of() { "$program" info --json "plan/part-$1.exr" 2> /dev/null | sed -n 's/^ *"samples_per_pixel": \([0-9]*\).*/\1/p'; }
has_checkpoint() { [ -n "$(samples_of "$1")" ]; }
expect() { grep -qF -- "$2" "$1" || fail "$1 does not say: $2"; }

submitted
said "sh plan/submit.sh: array $array of 8 tasks, and job $merge_job, which merges"
for part in "${ended[@]}"; do
    wait_for 60 "part $part has a checkpoint" has_checkpoint "$part"
    rm "to-be-ended-$part"
done
pid=$(sed -n 's/^2 \([0-9]*\) .*/\1/p' starts.log)
kill -s KILL "$pid"
scancel "${array}_3"
# As Slurm does before a time limit. scancel takes the answer for a refusal, and would send the signal again after 5 s.
timeout 2 scancel --batch --signal=TERM "${array}_1" || true
wait_for 30 "task 2 has failed" has_state "${array}_2" FAILED
wait_for 30 "task 3 is cancelled" has_state "${array}_3" CANCELLED
wait_for 30 "task 1 is queued again" was_queued_again "${array}_1"
for part in "${ended[@]}"; do
    count=$(samples_of "$part")
    [ "$count" -lt 2048 ] || [ "$part" -eq 1 ] || fail "part $part was whole before it could be ended"
done
code=$(field "${array}_2" ExitCode)
[ "$code" = 137:0 ] || fail "task 2 was killed, and its exit code is $code"
said "task 1 got SIGTERM and is queued again; task 2 got SIGKILL and failed; task 3 was cancelled"

# Meanwhile the same picture in one piece.
"$program" --batch "${picture[@]}" --out whole.exr > whole.log 2>&1 &
whole=$!
wait_for 120 "the merge has ended" has_ended "$merge_job"
wait "$whole" || fail "the single run failed"
[ "$(field "${array}_1" JobState)" = COMPLETED ] || fail "task 1 did not go on"
expect plan/part-1.log " of them new) per pixel"
[ "$(field "$merge_job" ExitCode)" = 1:0 ] || fail "the merge did not end with 1"
expect plan/merge.log "part 2: part-2.exr has $(samples_of 2) of 2048 samples per pixel"
expect plan/merge.log "part 3: part-3.exr has $(samples_of 3) of 2048 samples per pixel"
expect plan/merge.log "6 of 8 parts are complete"
said "task 1 went on from its checkpoint; the merge has the picture so far and names parts 2 and 3"

if "$program" merge plan --check > check.log 2>&1; then fail "--check finds nothing missing"; fi
numbers=$(sed -n 's/.*(\(--array=[0-9,]*\) in Slurm).*/\1/p' check.log)
[ "$numbers" = --array=2,3 ] || fail "--check prints the numbers $numbers"
again=$(cd plan && sbatch --parsable --partition=test "$numbers" parts.sbatch)
wait_for 60 "tasks 2 and 3 have ended" has_ended "$again"
for part in 2 3; do
    [ "$(field "${again}_$part" ExitCode)" = 0:0 ] || fail "task $part failed again"
    expect "plan/part-$part.log" " of them new) per pixel"
done
"$program" merge plan --check > check.log 2>&1 || fail "parts are missing: $(cat check.log)"
said "sbatch $numbers parts.sbatch: both continued from their checkpoints; all parts are complete"

# A byte in the middle of the sums becomes another one.
byte=$(od -An -tu1 -j250000 -N1 plan/part-6.exr)
printf '%b' "\\0$(printf '%o' $((byte ^ 1)))" | dd of=plan/part-6.exr bs=1 seek=250000 conv=notrunc status=none
if "$program" merge plan --check > check.log 2>&1; then fail "the damage is not found"; fi
expect check.log "part 6: plan/part-6.exr is damaged"
expect check.log "7 of 8 parts are complete"
command=$(grep ' render-part ' check.log)
case $command in
"$program render-part plan/plan.json --part 6 "*) ;;
*) fail "the command for part 6 is: $command" ;;
esac
sh -c "$command" > again.log 2>&1 || fail "the command that --check prints failed"
[ -e plan/part-6.exr.damaged ] || fail "the damaged film was not put aside"
said "a byte of part 6 was flipped; merge --check names it, and its command renders it again"

submitted
wait_for 60 "all has ended" has_ended "$array,$merge_job"
[ "$(field "$merge_job" ExitCode)" = 0:0 ] || fail "the merge is not complete"
for part in {0..7}; do
    [ "$(grep -c 'is complete: samples' "plan/part-$part.log")" -ge 1 ] || fail "part $part was rendered again"
done
said "sh plan/submit.sh once more: every task finds its part whole, and the merge ends with 0"

for part in {0..7}; do "$program" info "plan/part-$part.exr" | sed -n "s/^backend */         part $part: /p"; done | tee backends.log
[ "$(cut -d: -f2 backends.log | sort -u | wc -l)" -ge 2 ] || fail "all parts were rendered alike"
# The checksums of all sums, which a film is refused without.
bands() { grep -a -m 1 '^bands = \[' "$1"; }
"$program" compare plan/picture.exr whole.exr > compare.log 2>&1 || fail "the pictures differ: $(cat compare.log)"
expect compare.log "equal to the bit"
[ "$(bands plan/picture.exr)" = "$(bands whole.exr)" ] || fail "the sums differ"
[ "$(bands whole.exr)" != "$(bands plan/part-0.exr)" ] || fail "the checksums do not tell sums apart"
said "the picture and its sums are equal to the bit to those of one run"
