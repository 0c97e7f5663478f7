#!/usr/bin/env bash
# cluster.sh [BUILD]: runs sweeps on a real Slurm. Starts munged, slurmctld and two slurmd on this machine and stops them afterwards.
# Submits an array of jobs, one of its tasks again alone, and a job of two ranks, one on each node, and compares their tables with that of
# one process, byte for byte. Exit status 1 when one differs or does not end. Needs hertzline in BUILD (default: build/release), and
# Debian's slurm-wlm and munge: install_packages.sh --optional.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "${1:-build/release}")
for program in munged slurmctld slurmd sbatch srun; do
    PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || { echo "cluster.sh: needs Debian's slurm-wlm and munge" >&2; exit 1; }
done
export PATH=$PATH:/usr/sbin

folder=$(mktemp -d "${TMPDIR:-/tmp}/hertzline-cluster-XXXXXX")
started=()
tidy() {
    status=$?
    trap - EXIT
    [ ! -S "$folder/munge.socket" ] || timeout 10 scancel --user "$(id -un)" >/dev/null 2>&1 || true
    for ((i = ${#started[@]} - 1; i >= 0; --i)); do
        kill "${started[$i]}" 2>/dev/null || continue
        wait "${started[$i]}" 2>/dev/null || true
    done
    [ "$status" -eq 0 ] || tail -n 20 "$folder"/*.log >&2 || true
    rm -rf "$folder"
    exit "$status"
}
trap tidy EXIT
trap 'exit 1' INT TERM HUP

daemon() { # NAME COMMAND...
    name=$1 && shift
    "$@" >"$folder/$name.log" 2>&1 &
    started+=($!)
}

free_ports() { # COUNT
    /usr/bin/python3 -c "
import socket, sys
sockets = [socket.create_server(('127.0.0.1', 0)) for _ in range(int(sys.argv[1]))]
print(*(s.getsockname()[1] for s in sockets))" "$1"
}

wait_until() { # SECONDS COMMAND...
    end=$((SECONDS + $1)) && shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || { echo "cluster.sh: timed out: $*" >&2; exit 1; }
        sleep 0.2
    done
}

nodes_are_idle() { [ "$(sinfo --noheader --states=idle --format=%D)" = 2 ]; }

read -r control one two <<<"$(free_ports 3)"
user=$(id -un)
host=$(hostname -s)
chmod 755 "$folder"
mkdir -m 700 "$folder/munge"
dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
chmod 400 "$folder/munge/key"
cat >"$folder/slurm.conf" <<CONF
ClusterName=hertzline
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$control
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
TmpFS=$folder/tmp.%n
SchedulerParameters=sched_interval=1
NodeName=one NodeHostname=$host NodeAddr=127.0.0.1 Port=$one CPUs=2
NodeName=two NodeHostname=$host NodeAddr=127.0.0.1 Port=$two CPUs=2
PartitionName=all Nodes=one,two Default=YES State=UP OverSubscribe=NO
CONF
export SLURM_CONF=$folder/slurm.conf
mkdir "$folder"/{state,tmp.one,tmp.two}

daemon munged munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge.socket" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
wait_until 20 test -S "$folder/munge.socket"
daemon slurmctld slurmctld -D -f "$SLURM_CONF"
daemon one slurmd -D -N one -f "$SLURM_CONF"
daemon two slurmd -D -N two -f "$SLURM_CONF"
wait_until 60 nodes_are_idle
sinfo --format="%N: %D nodes of %c processors, %T, Slurm $(slurmctld -V | cut -d' ' -f2)" --noheader

sweep="paper-vitreous-carbon --vary chain.preload_n=0.01..2:log:200 --vary end.material=pyrex,acrylic --jobs 1"
submit() { # NAME OPTION... COMMAND: waits for the job
    name=$1 && shift
    sbatch --wait --quiet --chdir="$folder" --output="$folder/$name.%a.log" "${@:1:$#-1}" --wrap="${*: -1}"
}

echo "one process ..."
# shellcheck disable=SC2086  # a list of words
"$build/hertzline" sweep $sweep -o "$folder/alone.csv" >"$folder/alone.log" 2>&1

merge() { # NAME PARTS: joins the parts and compares
    "$build/hertzline" sweep --merge "$folder/$1.csv".*-of-"$2".journal -o "$folder/$1.csv" >"$folder/merge.log" 2>&1
    cmp "$folder/alone.csv" "$folder/$1.csv"
}

echo "an array of 4 jobs, the third of which is lost and submitted again ..."
submit array --array=1-4 --ntasks=1 "exec '$build/hertzline' sweep $sweep --shard slurm -o array.csv"
rm "$folder/array.csv.3-of-4.journal"
submit again --array=3 --ntasks=1 "exec '$build/hertzline' sweep $sweep --shard slurm/4 --resume -o array.csv"
merge array 4

echo "2 ranks on 2 nodes ..."
submit ranks --nodes=2 --ntasks-per-node=1 "exec srun '$build/hertzline' sweep $sweep --shard mpi -o ranks.csv"
merge ranks 2
echo "all three tables are the same: $(wc -l <"$folder/alone.csv") lines, $(cksum <"$folder/alone.csv")"
