#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""github_service.py FOLDER: the part of GitHub's API for comments. FOLDER/port has its port, FOLDER/asked a line for each request."""
import http.server
import json
import os
import sys

folder = sys.argv[1]
os.makedirs(folder, exist_ok=True)
comments = []


class Service(http.server.BaseHTTPRequestHandler):
    def answer(self):
        with open(os.path.join(folder, "asked"), "a", encoding="utf-8") as file:
            file.write(f"{self.command} {self.path.split('?')[0]}\n")
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if self.headers.get("Authorization") != "Bearer secret":
            reply, code = {"message": "Bad credentials"}, 401
        elif self.command == "GET":
            reply, code = comments, 200
        else:
            comment = {"id": 1, "body": json.loads(body)["body"]}
            comments[:] = [comment]
            reply, code = comment, 200
        text = json.dumps(reply).encode()
        self.send_response(code)
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)

    do_GET = do_POST = do_PATCH = answer

    def log_message(self, *_):
        pass


server = http.server.HTTPServer(("127.0.0.1", 0), Service)
with open(os.path.join(folder, "port.new"), "w", encoding="utf-8") as file:
    file.write(str(server.server_port))
os.rename(os.path.join(folder, "port.new"), os.path.join(folder, "port"))
server.serve_forever()
