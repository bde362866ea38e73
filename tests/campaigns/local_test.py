#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A campaign here: killed in mid-run and gone on with, in shards, it gives the bytes of one call; and each run again by itself has the digest
of its record. Exit code: 0 it does, 1 it does not."""
import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile

from slurm_cluster import Broken, processes, until
from slurm_test import CAMPAIGN, check, read, read_or_nothing, records

RUNS, WAITING, REFUSED = 3, 75, 65


class Bench:
    def __init__(self, program, campaign):
        self.program, self.campaign = program, campaign

    def command(self, output, *words):
        return [self.program, "campaign", self.campaign, "--output", output, "--quiet", *words]

    def __call__(self, output, *words):
        return subprocess.run(self.command(output, *words), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)


def runs_below(pid):
    return [child for child, parent, _, _ in processes() if parent == pid and b"\0run\0" in read_or_nothing(f"/proc/{child}/cmdline")]


def killed_in_mid_run(bench, output):
    with subprocess.Popen(bench.command(output, "--shard", "1/2", "--jobs", "1")) as process:
        run = until(lambda: runs_below(process.pid) or process.poll() is not None, "a run")
        check(run is not True, "the shard ended before it could be killed")
        process.send_signal(signal.SIGKILL)
    # The run ends with the campaign that started it.
    until(lambda: not os.path.exists(f"/proc/{run[0]}") or b"\0run\0" not in read_or_nothing(f"/proc/{run[0]}/cmdline"), "the end of the run")


def test(program, base, folder):
    campaign = os.path.join(folder, "plate.yaml")
    with open(campaign, "w", encoding="utf-8") as file:
        file.write(CAMPAIGN.format(base=base).replace("repeats: 2", "repeats: 1"))
    bench, whole, parts = Bench(program, campaign), os.path.join(folder, "whole"), os.path.join(folder, "parts")
    done = bench(whole, "--jobs", "2")
    check(done.returncode == 0, f"exit code {done.returncode}: {done.stdout}")
    killed_in_mid_run(bench, parts)
    check(len(records(parts)) < 2, "the killed shard had done all its runs")
    check(bench(parts, "--merge").returncode == WAITING, "merging is no success while runs are missing")
    for shard in ("2/2", "1/2", "1/2"):
        done = bench(parts, "--shard", shard, "--jobs", "1")
        check(done.returncode == 0, f"shard {shard}: exit code {done.returncode}: {done.stdout}")
    check(bench(parts, "--merge").returncode == 0, "merging fails although all runs are there")
    check(read(os.path.join(whole, "results.jsonl")) == read(os.path.join(parts, "results.jsonl")), "the merged bytes differ")
    check(not os.path.exists(os.path.join(parts, "runs")), "what the killed shard left was not swept")
    check(read(os.path.join(parts, "campaign.html")).lower().startswith(b"<!doctype html>"), "there is no page")

    lines = [json.loads(line) for line in read(os.path.join(whole, "results.jsonl")).splitlines()]
    check([line["run"] for line in lines] == list(range(RUNS)), "the runs are not in order")
    check(len({line["digest"] for line in lines}) == RUNS, "runs of different machines have one digest")
    alone = os.path.join(folder, "alone")
    subprocess.run([program, "run", os.path.join(whole, "scenarios", "000001.yaml"), "--results-dir", alone, "--jobs", "1", "--no-pictures",
                    "--quiet"], stdout=subprocess.DEVNULL, check=False)
    verdict = json.loads(read(os.path.join(alone, "plate-000001", "latest", "verdict.json")))
    check(verdict["digest"] == lines[1]["digest"], "the run by itself has another digest than its record")

    with open(campaign, "a", encoding="utf-8") as file:
        file.write("# A remark.\n")
    done = bench(parts)
    check(done.returncode == REFUSED and "name another folder" in done.stdout, f"a changed campaign goes on in the same folder: {done.stdout}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", required=True, metavar="FOLDER")
    parser.add_argument("--base", required=True, metavar="SCENARIO")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kerfbench-campaign-") as folder:
        try:
            test(os.path.join(args.build, "bin", "kerfbench"), os.path.abspath(args.base), folder)
        except (AssertionError, Broken, OSError, subprocess.SubprocessError) as error:
            print(f"local_test: {error}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
