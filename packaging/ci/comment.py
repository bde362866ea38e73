#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""comment.py SUMMARY: puts a summary under the pull request that a GitHub job belongs to, once; the next run replaces it.

By the variables of GitHub Actions: GITHUB_API_URL, GITHUB_REPOSITORY, GITHUB_EVENT_PATH, and GITHUB_TOKEN with pull-requests: write.
Ends with 0 where there is no pull request, or no right to comment on it, as on those from forks: the verdict does not depend on it.
"""
import json
import os
import sys
import urllib.error
import urllib.request

MARK = "<!-- kerfbench summary -->"


def request(method, path, body=None):
    asked = urllib.request.Request(
        f"{os.environ['GITHUB_API_URL']}/repos/{os.environ['GITHUB_REPOSITORY']}/{path}", method=method,
        data=None if body is None else json.dumps(body).encode(),
        headers={"Authorization": f"Bearer {os.environ['GITHUB_TOKEN']}", "Accept": "application/vnd.github+json",
                 "Content-Type": "application/json"})
    with urllib.request.urlopen(asked, timeout=30) as answer:
        return json.load(answer)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        # GitHub takes no more than 65 536 characters.
        body = f"{MARK}\n{file.read()[:60000]}"
    with open(os.environ["GITHUB_EVENT_PATH"], encoding="utf-8") as file:
        number = json.load(file).get("pull_request", {}).get("number")
    if number is None:
        print("no pull request: nothing to comment on")
        return
    try:
        page = 1
        while True:
            comments = request("GET", f"issues/{int(number)}/comments?per_page=100&page={page}")
            ours = [c for c in comments if c["body"].startswith(MARK)]
            if ours:
                request("PATCH", f"issues/comments/{int(ours[0]['id'])}", {"body": body})
                return
            if len(comments) < 100:
                break
            page += 1
        request("POST", f"issues/{int(number)}/comments", {"body": body})
    except urllib.error.HTTPError as error:
        if error.code not in (401, 403, 404):
            raise
        print(f"no right to comment (HTTP {error.code}): the summary is on the job's page")


main()
