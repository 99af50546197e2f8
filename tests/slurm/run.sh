#!/usr/bin/env bash
# Runs the script of docs/many-machines.md on a real Slurm: tests/slurm/run.sh [PROGRAM], by default
# target/release/weekender. Needs Debian's packages slurm-wlm and munge; starts a cluster of its own in a temporary
# directory and removes it. Without the packages it says that nothing was tested, or fails where
# WEEKENDER_REQUIRE_SLURM=1 is set.
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
    echo "NOT TESTED: a picture on Slurm; there is no $tool (install slurm-wlm and munge)" >&2
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
        tail -n 30 "$work"/cluster/log/*.log "$work"/*.log 2> /dev/null || true
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

# Different levels of the processor, of those that round alike. One level is enough.
levels=()
for isa in avx512 avx2 neon; do
    if "$program" --batch --size 8x8 --samples 1 --device cpu --isa "$isa" --out "$work/try.png" > /dev/null 2>&1; then
        levels+=("--isa=$isa")
    fi
done
[ "${#levels[@]}" -gt 0 ] || levels=("--isa=auto")
slow="${levels[0]} --simd=off"

# The program of this cluster, whose nodes have different processors. Parts that are to be ended early have one lane when
# they first start: that takes seconds, and the film must not show it.
ended=(1 2 3)
touch "${ended[@]/#/$work/to-be-ended-}"
mkdir "$work/bin"
cat > "$work/bin/weekender" << END
#!/usr/bin/env bash
if [ "\$1" != --batch ]; then exec -a weekender "$program" "\$@"; fi
task=\${SLURM_ARRAY_TASK_ID:-0}
levels=($(printf '"%s" ' "${levels[@]}"))
level=\${levels[task % ${#levels[@]}]}
if [ -e "$work/to-be-ended-\$task" ]; then level="$slow"; fi
echo "\$task \$\$ \$level" >> "$work/starts.log"
exec -a weekender "$program" "\$@" --device cpu --threads 1 --every 0.1s \$level
END
chmod +x "$work/bin/weekender"
export PATH=$work/bin:$PATH

cluster_up "$work/cluster" 4
said "$(sinfo --version), munge: one node with 4 slots is idle"

# The documented lines, with a smaller picture and 8 parts of 1024 samples.
cd "$work"
docs=$here/../../docs/many-machines.md
sed -n '/^```bash$/,/^```$/{//d;p}' "$docs" |
    sed 's/--array=0-31/--array=0-7/; s/ID \* 128/ID * 1024/; s/first + 128/first + 1024/; s/1200x675/160x90/' > parts.sbatch
[ "$(grep -cE '0-7|\* 1024|160x90|first \+ 1024' parts.sbatch)" = 3 ] || fail "the script has changed: $(cat parts.sbatch)"
merge=$(sed -n "s/^sbatch .* --wrap '\(.*\)'$/\1/p" "$docs" | sed 's/4096/8192/')
[[ "$merge" = weekender\ merge\ *8192* ]] || fail "the merge has changed: $merge"

# Submits the array and the merge. Sets the numbers of both.
submitted() {
    array=$(sbatch --parsable --partition=test --time=10 parts.sbatch)
    merge_job=$(sbatch --parsable --partition=test --dependency="afterany:$array" --output=merge.log --wrap "$merge")
}
# What Slurm says about a job, such as JobState.
field() { scontrol show job "$1" --oneliner | sed -nE "s/^(.* )?$2=([^ ]*).*/\2/p"; }
has_ended() {
    local left
    left=$(squeue --noheader --job="$1" 2> /dev/null) && [ -z "$left" ]
}
has_state() { [ "$(field "$1" JobState)" = "$2" ]; }
was_queued_again() { [ "$(field "$1" Restarts)" = 1 ]; }
samples_of() { "$program" info --json "part-$1.exr" 2> /dev/null | sed -n 's/^ *"samples_per_pixel": \([0-9]*\).*/\1/p'; }
has_checkpoint() { [ -n "$(samples_of "$1")" ]; }
# Fails if the last run rendered all of the part, or none.
went_on() {
    local new
    new=$(sed -nE 's/^samples +1024 per pixel, ([0-9]+) of them new.*/\1/p' "part-$1.log" | tail -n 1)
    [[ "$new" -gt 0 && "$new" -lt 1024 ]] || fail "part $1 did not go on: $new of its samples are new"
}
expect() { grep -qF -- "$2" "$1" || fail "$1 does not say: $2"; }

submitted
said "sbatch parts.sbatch: array $array of 8 tasks, and job $merge_job, which merges"
for part in "${ended[@]}"; do
    wait_for 60 "part $part has a checkpoint" has_checkpoint "$part"
    rm "to-be-ended-$part"
done
pid=$(sed -n 's/^2 \([0-9]*\) .*/\1/p' starts.log)
kill -s KILL "$pid"
scancel "${array}_3"
# As Slurm does before a time limit. scancel takes the answer for a refusal, and would send the signal again after 5 s.
timeout 2 scancel --signal=TERM "${array}_1" || true
wait_for 30 "task 2 has failed" has_state "${array}_2" FAILED
wait_for 30 "task 3 is cancelled" has_state "${array}_3" CANCELLED
wait_for 30 "task 1 is queued again" was_queued_again "${array}_1"
for part in "${ended[@]}"; do
    count=$(samples_of "$part")
    [ "$count" -lt 1024 ] || [ "$part" -eq 1 ] || fail "part $part was whole before it could be ended"
done
code=$(field "${array}_2" ExitCode)
[ "$code" = 137:0 ] || fail "task 2 was killed, and its exit code is $code"
said "task 1 got SIGTERM and is queued again; task 2 got SIGKILL and failed; task 3 was cancelled"

# Meanwhile the same picture in one piece.
"$program" --batch --scene book --size 160x90 --samples 8192 --device cpu --out whole.exr > whole.log 2>&1 &
whole=$!
wait_for 120 "the merge has ended" has_ended "$merge_job"
wait "$whole" || fail "the single run failed"
[ "$(field "${array}_1" JobState)" = COMPLETED ] || fail "task 1 did not go on"
went_on 1
[ "$(field "$merge_job" ExitCode)" = 1:0 ] || fail "the merge did not end with 1"
for part in 2 3; do
    gap=$((1024 * part + $(samples_of $part)))..$((1024 * part + 1024))
    expect merge.log "weekender --batch --sample-range=$gap --checkpoint=part-$part.exr --continue"
done
[ "$(grep -c ' --continue$' merge.log)" = 2 ] || fail "more than parts 2 and 3 is missing"
said "task 1 went on from its checkpoint; the merge has the picture so far and names what parts 2 and 3 lack"

again=$(sbatch --parsable --partition=test --array=2,3 parts.sbatch)
wait_for 60 "tasks 2 and 3 have ended" has_ended "$again"
for part in 2 3; do
    [ "$(field "${again}_$part" ExitCode)" = 0:0 ] || fail "task $part failed again"
    went_on "$part"
done
check=(weekender merge part-*.exr --samples 8192)
"${check[@]}" > check.log 2>&1 || fail "parts are missing: $(cat check.log)"
said "sbatch --array=2,3 parts.sbatch: both continued from their checkpoints; nothing is missing"

# A byte in the middle of the sums becomes another one.
byte=$(od -An -tu1 -j250000 -N1 part-6.exr)
printf '%b' "\\0$(printf '%o' $((byte ^ 1)))" | dd of=part-6.exr bs=1 seek=250000 conv=notrunc status=none
if "${check[@]}" > check.log 2>&1; then fail "the damage is not found"; fi
expect check.log "part-6.exr is damaged"
command=$(grep ' --continue$' check.log)
[[ "$command" = *" --sample-range=6144..7168 --checkpoint=part-6.exr --continue" ]] || fail "the command for part 6 is: $command"
sh -c "$command" > again.log 2>&1 || fail "the command that merge prints failed"
[ -e part-6.exr.damaged ] || fail "the damaged film was not put aside"
said "a byte of part 6 was flipped; merge names it, and its command renders it again"

stat --format='%n %y' part-?.exr > before.log
submitted
wait_for 60 "all has ended" has_ended "$array,$merge_job"
[ "$(field "$merge_job" ExitCode)" = 0:0 ] || fail "the merge is not complete"
stat --format='%n %y' part-?.exr | cmp - before.log || fail "a part was rendered again"
said "the array once more: every task finds its part whole, and the merge ends with 0"

for part in {0..7}; do "$program" info "part-$part.exr" | sed -n "s/^backend */         part $part: /p"; done | tee backends.log
[ "$(cut -d: -f2 backends.log | sort -u | wc -l)" -ge 2 ] || fail "all parts were rendered alike"
# The checksums of all sums, which a film is refused without.
bands() { grep -a -m 1 '^bands = \[' "$1"; }
"$program" compare book.exr whole.exr > compare.log 2>&1 || fail "the pictures differ: $(cat compare.log)"
expect compare.log "equal to the bit"
[ "$(bands book.exr)" = "$(bands whole.exr)" ] || fail "the sums differ"
[ "$(bands whole.exr)" != "$(bands part-0.exr)" ] || fail "the checksums do not tell sums apart"
said "the picture and its sums are equal to the bit to those of one run"
