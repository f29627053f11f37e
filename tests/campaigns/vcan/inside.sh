#!/bin/sh
# The first process of user-mode Linux: a vcan, the simulated rig on it, two runs. $JOB, $PYTHON, $ROOT and $OPTIONS come
# from the kernel's command line by way of $JOB/environment. Everything is written to memory: what waits for the host's
# disk stops this kernel, which has one processor, with everything on it.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t tmpfs tmpfs /run
mkdir -p /dev/pts /dev/shm /run/job
mount -t devpts devpts /dev/pts
mount -t tmpfs tmpfs /dev/shm
. "$(tr ' ' '\n' < /proc/cmdline | sed -n 's/^job=//p')/environment"
cd /run/job || exit 1
export HOME=/run/job TMPDIR=/run/job XDG_RUNTIME_DIR=/run/job XDG_STATE_HOME=/run/job PYTHONPATH="$ROOT"
export PYTHONDONTWRITEBYTECODE=1

end() {
    cp -r /run/job/. "$JOB"
    echo o > /proc/sysrq-trigger
    sleep 5
}

ip link set lo up
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan; do
    insmod "$MODULES/$(uname -r)/kernel/$module.ko" || echo "no module $module" >> failed
done
ip link add dev vcan0 type vcan && ip link set vcan0 up || echo "no vcan0" >> failed
[ -e failed ] && end
uname -r > kernel
ip -d link show vcan0 > link

# Two processes of equal rights share the processor better than two that each keep it for 100 ms (SCHED_RR).
tester() {
    setpriv --bounding-set=-sys_nice "$PYTHON" -c "from tester.cli.main import main; main()" "$@"
}

# What is imported late comes from the host's disk: once before it counts.
tester run "$JOB/recipe.yaml" --yes --seed 1 --out memory > memory.out 2> memory.err

tester sim --can socketcan:vcan0 --seed 1 $OPTIONS --write-rig rig.yaml > sim.out 2> sim.err &
rig=$!
tries=0
until grep -q ready sim.out || [ $tries -gt 60 ]; do sleep 1; tries=$((tries + 1)); done

# A host that keeps this kernel waiting ends a run before its time: it is begun again, and how often is told.
attempts=0
code=1
while [ $code -ne 0 ] && [ $attempts -lt 3 ]; do
    attempts=$((attempts + 1))
    rm -rf first
    tester run "$JOB/recipe.yaml" --rig rig.yaml --accept-risk slow-kernel --yes --out first > first.out 2> first.err
    code=$?
    cp first.err "first.$attempts.err"
done
echo $attempts > first.attempts
echo $code > first.code

attempts=0
until grep -qs "^tripped: second master" second.err || [ $attempts -ge 3 ]; do
    attempts=$((attempts + 1))
    rm -rf second
    tester run "$JOB/recipe.yaml" --rig rig.yaml --accept-risk slow-kernel --yes --out second > second.out 2> second.err &
    run=$!
    tries=0
    until grep -q "1#, " second.err || [ $tries -gt 120 ] || ! kill -0 $run; do sleep 1; tries=$((tries + 1)); done
    cansend vcan0 "$FOREIGN"
    wait $run
    echo $? > second.code
    cp second.err "second.$attempts.err"
done
echo $attempts > second.attempts
kill $rig
wait $rig
end
