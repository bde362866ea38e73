#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A campaign on a Slurm cluster of two nodes, of which one dies in the middle of a run, gives the bytes of a local one. Exit code: 0 it
does, 1 it does not, 77 there is no Slurm here."""
import argparse
import os
import subprocess
import sys
import tempfile

import slurm_cluster
from slurm_cluster import Broken, Cluster, until

RUNS, SHARDS = 6, 3
CAMPAIGN = """version: 1
name: plate
base: {base}
set: {{twin: fast}}
repeats: 2
factors:
  - name: imperfections
    key: imperfections
    values: [ideal, static, dynamic]
"""


def read(path):
    with open(path, "rb") as file:
        return file.read()


def check(holds, what):
    if not holds:
        raise AssertionError(what)


def run_is_under_way(cluster, node):
    of_jobs, _ = cluster.processes_on(node)
    return any(b"\0run\0" in read_or_nothing(f"/proc/{pid}/cmdline") for pid, _, _ in of_jobs)


def read_or_nothing(path):
    try:
        return read(path)
    except OSError:
        return b""


def records(output):
    folder = os.path.join(output, "records", "000")
    return set(os.listdir(folder)) if os.path.isdir(folder) else set()


def on_slurm(program, campaign, output, environment):
    return subprocess.Popen([program, "campaign", campaign, "--output", output, "--submit", "--shards", str(SHARDS), "--jobs", "1", "--poll",
                             "0.2"], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def test(program, base, folder):
    campaign = os.path.join(folder, "plate.yaml")
    with open(campaign, "w", encoding="utf-8") as file:
        file.write(CAMPAIGN.format(base=base))
    local, remote = os.path.join(folder, "local"), os.path.join(folder, "deep", "in", "slurm")
    subprocess.run([program, "campaign", campaign, "--output", local, "--jobs", "2", "--quiet"], check=True)
    with Cluster() as cluster:
        with on_slurm(program, campaign, remote, cluster.environment) as waiting:
            until(lambda: run_is_under_way(cluster, "n2") or waiting.poll() is not None, "a run on n2")
            check(waiting.poll() is None, "the campaign ended before a node could be killed")
            cluster.kill_node("n2")
            before = records(remote)
            # A controller finds out by itself after half a minute; an operator says so.
            cluster.ask("scontrol", "update", "nodename=n2", "state=down", "reason=killed")
            said, _ = waiting.communicate(timeout=120)
        print(said)
        check(waiting.returncode == 0, f"exit code {waiting.returncode}")
        check(cluster.restarts() == 1, f"{cluster.restarts()} tasks were queued again")
    check(len(before) < RUNS, "all runs had a record when the node died")
    check(read(os.path.join(local, "results.jsonl")) == read(os.path.join(remote, "results.jsonl")), "the merged bytes differ")
    check(read(os.path.join(local, "results.sha256")) == read(os.path.join(remote, "results.sha256")), "the digests differ")
    check(read(os.path.join(local, "results.jsonl")).count(b"\n") == RUNS, "not all runs are there")
    check(not os.path.exists(os.path.join(remote, "runs")), "what the dead node left was not swept")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True, metavar="FOLDER")
    parser.add_argument("--base", required=True, metavar="SCENARIO")
    args = parser.parse_args()
    missing = slurm_cluster.missing()
    if missing:
        print(f"SKIPPED: Slurm is not here ({', '.join(missing)} missing): a campaign on a cluster was NOT tested. "
              "packages.txt, part ci, has its packages.")
        return 77
    with tempfile.TemporaryDirectory(prefix="kerfbench-campaign-") as folder:
        try:
            test(os.path.join(args.build, "bin", "kerfbench"), os.path.abspath(args.base), folder)
        except (AssertionError, Broken, OSError, subprocess.SubprocessError) as error:
            print(f"slurm_test: {error}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
