# shellcheck shell=bash
# A Slurm cluster of one node for a test: cluster_up DIR SLOTS, cluster_down DIR. Its keys, sockets, state and logs are in
# DIR, which must be absolute. Its daemons run as the user who starts them, and nothing else on the machine is touched.

# The first tool that is needed and not there.
missing_tool() {
    local tool
    for tool in munged munge slurmctld slurmd sbatch scancel scontrol sinfo squeue; do
        command -v "$tool" > /dev/null || { echo "$tool" && return; }
    done
}

# Two ports, one after the other, on which nothing listens. Below those that systems give to clients.
free_ports() {
    local port
    for _ in {1..50}; do
        port=$((16000 + RANDOM % 16000))
        if ! (: < "/dev/tcp/127.0.0.1/$port") 2> /dev/null && ! (: < "/dev/tcp/127.0.0.1/$((port + 1))") 2> /dev/null; then
            echo "$port"
            return
        fi
    done
    return 1
}

write_configuration() {
    local dir=$1 slots=$2 node user port
    node=$(hostname -s)
    user=$(id -un)
    port=$(free_ports)
    # - A credential lives for 5 s instead of 2 minutes: a task that is queued again starts no earlier.
    # - linuxproc and none: control groups would need an init system.
    # - config_overrides: the node has as many slots as the file says, whatever the machine has.
    cat > "$dir/slurm.conf" << END
ClusterName=weekender-test
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=$user
SlurmdUser=$user
AuthInfo=socket=$dir/run/munge.sock,cred_expire=5
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/run/slurmctld.pid
SlurmdPidFile=$dir/run/slurmd.pid
SlurmctldLogFile=$dir/log/slurmctld.log
SlurmdLogFile=$dir/log/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=bf_interval=2,sched_interval=2,batch_sched_delay=0
SlurmdParameters=config_overrides
NodeName=$node NodeAddr=127.0.0.1 CPUs=$slots RealMemory=1000 State=UNKNOWN
PartitionName=test Nodes=$node Default=YES MaxTime=INFINITE State=UP
END
}

node_is_idle() {
    [ "$(timeout 5 sinfo --noheader --format=%T 2> /dev/null)" = idle ]
}

# Starts the cluster and waits until its node is idle. Sets SLURM_CONF, by which every process of the cluster is known.
cluster_up() {
    local dir=$1 slots=$2
    mkdir -p "$dir"/{key,run,state,spool,log}
    # munged wants everybody to reach its socket, and nobody its key.
    chmod 755 "$dir" "$dir/run"
    chmod 700 "$dir"/{key,state,spool}
    (umask 077 && head -c 1024 /dev/urandom > "$dir/key/key")
    write_configuration "$dir" "$slots"
    export SLURM_CONF=$dir/slurm.conf
    # Ctrl-C in the terminal is for the test, which then stops the daemons in order.
    setsid munged --foreground --key-file="$dir/key/key" --seed-file="$dir/key/seed" --socket="$dir/run/munge.sock" \
        --pid-file="$dir/run/munged.pid" --log-file="$dir/log/munged.log" \
        > "$dir/log/munged.out" 2>&1 < /dev/null &
    wait_for 20 "munge answers" munge_answers "$dir"
    setsid slurmctld -D > "$dir/log/slurmctld.out" 2>&1 < /dev/null &
    setsid slurmd -D -N "$(hostname -s)" > "$dir/log/slurmd.out" 2>&1 < /dev/null &
    wait_for 40 "the node is idle" node_is_idle
}

munge_answers() {
    munge --no-input --socket="$1/run/munge.sock" > /dev/null 2>&1
}

# The processes that the cluster and its jobs have started: they have its configuration in their environment. Those that
# have ended and were not waited for have none.
cluster_processes() {
    local dir=$1 process
    for process in /proc/[0-9]*; do
        if tr '\0' '\n' < "$process/environ" 2> /dev/null | grep -qxF "SLURM_CONF=$dir/slurm.conf"; then
            echo "${process#/proc/}"
        fi
    done 2> /dev/null
}

queue_is_empty() {
    local jobs
    jobs=$(timeout 5 squeue --noheader 2> /dev/null) && [ -z "$jobs" ]
}

no_process_is_left() {
    [ -z "$(cluster_processes "$1")" ]
}

# Ends the jobs, then the daemons, then what is still there; removes DIR.
cluster_down() {
    local dir=$1 signal daemons
    [ -d "$dir" ] || return 0
    if [ -e "$dir/slurm.conf" ]; then
        if [ "$(timeout 5 sinfo --noheader 2> /dev/null | wc -l)" -gt 0 ]; then
            timeout 10 scancel --user="$(id -un)" 2> /dev/null
            soon 10 queue_is_empty
        fi
        for signal in TERM KILL; do
            mapfile -t daemons < <(cluster_processes "$dir")
            [ "${#daemons[@]}" -gt 0 ] || break
            kill -s "$signal" "${daemons[@]}" 2> /dev/null
            soon 10 no_process_is_left "$dir"
        done
        if ! no_process_is_left "$dir"; then
            echo "still running: $(cluster_processes "$dir" | tr '\n' ' ')" >&2
            return 1
        fi
    fi
    rm -rf "$dir"
}

# soon SECONDS COMMAND...: whether the command succeeds within this time.
soon() {
    local end=$((SECONDS + $1))
    shift
    until "$@"; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep .1
    done
}

# wait_for SECONDS WHAT COMMAND...: fails if the command does not succeed within this time.
wait_for() {
    local seconds=$1 what=$2
    shift 2
    soon "$seconds" "$@" || fail "not within $seconds s: $what"
}
