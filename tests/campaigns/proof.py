#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One campaign of 500 runs, here and on a Slurm cluster of two nodes of which one loses its power in mid-run and comes back: are the merged
bytes equal? With times and runs per hour. Writes tests/campaigns/RESULTS.md; with --runs nothing is written. Exit code: 0 they are equal,
1 they are not, 2 something broke, 64 usage, 77 there is no Slurm here.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tests", "figures"))
import slurm_cluster  # noqa: E402
from slurm_cluster import Broken, Cluster, until  # noqa: E402
from slurm_test import read, records, run_is_under_way  # noqa: E402
import stamp  # noqa: E402

CAMPAIGN = os.path.join(ROOT, "fixtures", "campaigns", "label-faults.yaml")
PAGE = os.path.join(ROOT, "tests", "campaigns", "RESULTS.md")
RUNS, SHARDS = 500, 50
# A campaign of so many runs may take all day on a computer that does other things as well.
NET_S = 24 * 3600.0


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--runs", type=int, default=RUNS, help="so many of the campaign's runs")
    parser.add_argument("--output", metavar="FOLDER", help="keeps both results there")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


class Proof:
    def __init__(self, program, runs, folder):
        self.program, self.runs, self.folder = program, runs, folder
        self.campaign = os.path.join(folder, "campaign.yaml")
        with open(self.campaign, "w", encoding="utf-8") as file:
            file.write(f"extends: {CAMPAIGN}\ndraws: {runs}\n")
        self.local, self.slurm = os.path.join(folder, "local"), os.path.join(folder, "slurm")

    def here(self):
        begun = time.monotonic()
        subprocess.run([self.program, "campaign", self.campaign, "--output", self.local, "--jobs", "2", "--quiet"], check=True)
        return time.monotonic() - begun

    def on_slurm(self):
        """Two nodes of a processor each; n2 dies when a quarter of the runs have a record, and is back when its task was queued again."""
        shards = max(2, min(SHARDS, self.runs // 2))
        with Cluster(cpus=1) as cluster:
            begun = time.monotonic()
            command = [self.program, "campaign", self.campaign, "--output", self.slurm, "--submit", "--shards", str(shards), "--jobs", "1",
                       "--poll", "1", "--quiet"]
            with subprocess.Popen(command, env=cluster.environment) as waiting:
                until(lambda: len(records(self.slurm)) >= self.runs // 4 and run_is_under_way(cluster, "n2"), "a run on n2", NET_S)
                cluster.kill_node("n2")
                died, had = time.monotonic(), len(records(self.slurm))
                until(lambda: cluster.restarts() > 0, "the controller to queue the task of the dead node again", 300.0)
                requeued = time.monotonic()
                cluster.start_node("n2")
                if waiting.wait(NET_S) != 0:
                    raise Broken(f"the campaign on Slurm ended with exit code {waiting.returncode}")
            return {"s": time.monotonic() - begun, "shards": shards, "had": had, "died_s": died - begun, "requeue_s": requeued - died,
                    "restarts": cluster.restarts()}


def page_of(proof, here_s, slurm, digest, made_with):
    with open(os.path.join(proof.local, "analysis.json"), encoding="utf-8") as file:
        analysis = json.load(file)
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench campaign-proof: do not edit. -->",
             "# A campaign here and on Slurm", "",
             f"{proof.runs} runs of [label-faults.yaml](../../fixtures/campaigns/label-faults.yaml), here with two runs at a time, and on a "
             "Slurm cluster of two nodes with a processor each, all on one computer of two cores. The times "
             "are worth something only if it did nothing else.", "", made_with, "",
             "| | here | Slurm |", "|---|---|---|",
             f"| digest of results.jsonl | `{digest}` | the same |",
             f"| time | {here_s / 60:.1f} min | {slurm['s'] / 60:.1f} min |",
             f"| runs per hour | {3600 * proof.runs / here_s:.0f} | {3600 * proof.runs / slurm['s']:.0f} |",
             f"| shards | 1 | {slurm['shards']} |", "",
             f"One node lost its power {slurm['died_s'] / 60:.1f} min after the start: its daemon, its steps and the run that it was at were "
             f"killed when {slurm['had']} runs had a record. Slurm found out and queued its task again {slurm['requeue_s']:.0f} s later "
             f"({slurm['restarts']} task{'s' if slurm['restarts'] != 1 else ''} in all). The node came back after that. No run was lost, and "
             "none counts twice.", "", "## What the campaign tells", "",
             "| fault | runs | FAIL | half of them are found from (95 %) | nine of ten from (95 %) |", "|---|---|---|---|---|"]
    for fault in analysis["faults"]:
        found = fault["found_is_fail"]
        sizes = [found["fit"][key] for key in ("half_found", "nine_of_ten_found")] if found["fit"] else []
        told = [size_words(size) for size in sizes] or [f"not fitted: {found['not_fitted']}", bracket_words(found)]
        lines.append(f"| {fault['fault']} | {found['runs']} | {found['found']} | {told[0]} | {told[1]} |")
    good = next(row for rates in analysis["factors"] if rates["factor"] == "fault" for row in rates["values"] if row["value"] == "none")
    low, high = good["pass_rate_95"]
    lines += ["", f"Without a fault {good['runs']['PASS']} of {good['runs']['all']} runs are PASS ({100 * low:.1f} … {100 * high:.1f} %), "
              f"{good['runs']['FAIL']} FAIL, {good['runs']['NOT PROVEN']} NOT PROVEN.", ""]
    return "\n".join(lines)


def bracket_words(found):
    words = [f"missed up to {found['largest_missed']:.3g}"] if found["largest_missed"] is not None else []
    return ", ".join(words + ([f"found from {found['smallest_found']:.3g}"] if found["smallest_found"] is not None else []))


def number(value):
    return "none" if value is None else f"{value:.3g}"


def size_words(size):
    bounds = [number(size[key]).replace("none", "no bound") for key in ("low_95", "high_95")]
    return f"{size['size']:.3g} ({bounds[0]} … {bounds[1]})" + (", beyond the sizes that were tried" if size["extrapolated"] else "")


def prove(args, folder):
    proof = Proof(os.path.join(args.build, "bin", "kerfbench"), args.runs, os.path.abspath(folder))
    made_with = stamp.line_of("campaigns", "seed 2026")
    here_s = proof.here()
    print(f"here: {here_s:.0f} s, {3600 * args.runs / here_s:.0f} runs per hour", flush=True)
    slurm = proof.on_slurm()
    print(f"on Slurm: {slurm['s']:.0f} s, {3600 * args.runs / slurm['s']:.0f} runs per hour; n2 died after {slurm['died_s']:.0f} s with "
          f"{slurm['had']} records, its task was queued again {slurm['requeue_s']:.0f} s later", flush=True)
    if read(os.path.join(proof.local, "results.jsonl")) != read(os.path.join(proof.slurm, "results.jsonl")):
        print("the merged bytes differ", file=sys.stderr)
        return 1
    digest = read(os.path.join(proof.local, "results.sha256")).decode().split()[0]
    print(f"equal bytes, digest {digest}")
    if args.runs == RUNS:
        stamp.write(PAGE, page_of(proof, here_s, slurm, digest, made_with))
    return 0


def main():
    args = parsed()
    if slurm_cluster.missing():
        print(f"SKIPPED: Slurm is not here ({', '.join(slurm_cluster.missing())} missing): nothing was proven")
        return 77
    try:
        if args.output:
            os.makedirs(args.output, exist_ok=True)
            return prove(args, args.output)
        with tempfile.TemporaryDirectory(prefix="kerfbench-proof-") as folder:
            return prove(args, folder)
    except (Broken, OSError, subprocess.SubprocessError) as error:
        print(f"campaign-proof: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
