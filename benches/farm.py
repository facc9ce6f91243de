#!/usr/bin/env python3
"""Levels of many plants on HyperQueue, while workers die: each plant once, the bytes of one process, and what it costs.

Needs `pip install hyperqueue` and a built program. Grows the plants, makes levels of all in one process, then plans them
as a batch and hands the items to HyperQueue's server with two workers of one core. A task is killed in the middle, then
the server with both workers; a new one is given the whole plan again, and once more when all is done.

usage: farm.py PROGRAM [--plants 1000] [--leaves 20] [--folder target/farm]
"""

import argparse
import json
import multiprocessing
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

WORKERS = 2
# Any difference will do: the farm is measured, and a plant without a level would be a failure. Small pictures and little
# effort make tasks short, so that what the farm adds to each shows.
OPTIONS = ["--levels", "0.2", "--max-difference", "2", "--no-original", "--impostor=none", "--engine", "cpu"]
OPTIONS += ["--screen-height", "64", "--effort", "fast", "--textures", "keep"]
SPECIES = ["bush", "palmetto", "rowan", "birch"]
# Each task says how long it took, which HyperQueue does not.
TASK = """echo $$ $(date +%s%N) >> "$TIMES"
"$SECATEUR" batch run "$ITEM" --threads 1 -q
c=$?
echo $$ $(date +%s%N) >> "$TIMES"
exit $c"""


def grow(program, folder, count, leaves):
    plants = []
    for number in range(count):
        plant = folder / f"plant{number:04}.glb"
        species = SPECIES[number % len(SPECIES)]
        words = [program, "grow", species, "--leaves", str(leaves), "--seed", str(number), "-o", plant, "-q"]
        subprocess.run(words, check=True)
        plants.append(str(plant))
    return plants


def serve(server, items, times, program):
    """A server with its workers, which is given all items; ends when they are done."""
    from hyperqueue import Job, LocalCluster
    from hyperqueue.cluster import WorkerConfig

    with LocalCluster(str(server)) as cluster:
        for _ in range(WORKERS):
            cluster.start_worker(WorkerConfig(cores=1))
        client = cluster.client()
        job = Job(max_fails=None)
        for item in items:
            environment = {"SECATEUR": program, "ITEM": item, "TIMES": str(times)}
            job.program(["sh", "-c", TASK], env=environment, stdout=None, stderr=None)
        client.wait_for_jobs([client.submit(job)], raise_on_error=False)


def started(server, items, times, program):
    shutil.rmtree(server, ignore_errors=True)
    process = multiprocessing.get_context("spawn").Process(target=serve, args=(server, items, times, program))
    process.start()
    return process


def done(levels):
    return [entry for entry in levels.iterdir() if entry.name[0] != "." and entry.is_dir()] if levels.is_dir() else []


def wait_until(count, levels, process):
    while len(done(levels)) < count and process.is_alive():
        time.sleep(0.02)


def children(process):
    """The processes below one, by what Linux says of them."""
    found = []
    for thread in Path(f"/proc/{process}/task").glob("*/children"):
        for child in map(int, thread.read_text().split()):
            found += [child, *children(child)]
    return found


def kill(processes):
    for process in processes:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass


def farm(program, items, levels, folder):
    """Runs the batch as the head of this file says; the seconds that it took, those of its tasks, and how many were
    killed."""
    times, server = folder / "times", folder / "server"
    start = time.monotonic()
    process = started(server, items, times, program)
    wait_until(len(items) // 4, levels, process)
    kill(children(process.pid)[:2])
    kills = [time.time()]
    wait_until(len(items) // 2, levels, process)
    below = children(process.pid)
    kill([process.pid, *below])
    kills.append(time.time())
    process.join()
    process = started(server, items, times, program)
    process.join()
    seconds = time.monotonic() - start
    busy, killed = task_seconds(times.read_text().splitlines(), kills)
    process = started(server, items, times, program)
    process.join()
    return seconds, busy, killed


def task_seconds(lines, kills):
    """The seconds of all tasks, of killed ones until then, and how many these were."""
    begins, busy = {}, 0.0
    for line in lines:
        task, nanoseconds = line.split()
        at = int(nanoseconds) / 1e9
        if task in begins:
            busy += at - begins.pop(task)
        else:
            begins[task] = at
    ends = [min(kill for kill in kills if kill >= begin) for begin in begins.values()]
    return busy + sum(ends) - sum(begins.values()), len(begins)


def same_bytes(levels, alone):
    """How many files of the batch are those of the one process."""
    equal = 0
    for result in done(levels):
        for file in result.glob("*.glb"):
            assert file.read_bytes() == (alone / file.name).read_bytes(), file
            equal += 1
    return equal


def cpu_seconds(work):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    work()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--plants", type=int, default=1000)
    parser.add_argument("--leaves", type=int, default=20)
    parser.add_argument("--folder", type=Path, default=Path("target/farm"))
    args = parser.parse_args()
    program, folder = str(Path(args.program).resolve()), args.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "plants").mkdir(parents=True)
    plants = grow(program, folder / "plants", args.plants, args.leaves)
    levels, alone = folder / "levels", folder / "alone"

    one = [program, "lods", *plants, "-o", str(alone), *OPTIONS, "-q"]
    cpu_alone = cpu_seconds(lambda: subprocess.run(one, check=True, stdout=subprocess.DEVNULL))
    plan = [program, "batch", "plan", *plants, "-o", str(levels), *OPTIONS]
    text = subprocess.run(plan, check=True, stdout=subprocess.PIPE, text=True).stdout
    (folder / "items.jsonl").write_text(text)
    items = text.splitlines()

    seconds, busy, killed = farm(program, items, levels, folder)

    keys = sorted(json.loads(item)["key"] for item in items)
    assert sorted(entry.name for entry in done(levels)) == keys, "each plant once"
    equal = same_bytes(levels, alone)
    collect = [program, "batch", "collect", str(levels), "-o", str(folder / "report"), "--plan", str(folder / "items.jsonl")]
    subprocess.run(collect, check=True, stdout=subprocess.DEVNULL)
    left = [entry.name for entry in levels.iterdir() if entry.name not in keys]
    report = {
        "plants": len(items),
        "files_of_same_bytes": equal,
        "left_behind": left,
        "tasks_killed": killed,
        "seconds": round(seconds, 1),
        "task_seconds": round(busy, 1),
        "overhead_percent": round(100 * (1 - busy / (WORKERS * seconds)), 2),
        "cpu_seconds_of_one_process": round(cpu_alone, 1),
    }
    print(json.dumps(report, indent=2))


if __name__ == "__main__":
    sys.exit(main())
