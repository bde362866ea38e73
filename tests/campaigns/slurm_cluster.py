# SPDX-License-Identifier: Apache-2.0
"""A Slurm cluster on this computer: munged, slurmctld and two slurmd as plain processes of the caller, without root and without systemd.
What they write is in one folder, and they end with the `with` block."""
import getpass
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")
NODES = ("n1", "n2")
MARK = "KERFBENCH_CLUSTER"
READY_S, END_S = 30.0, 10.0

CONF = """ClusterName=kerf
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=cred_expire=5,socket={d}/munge.sock
StateSaveLocation={d}/state
SlurmdSpoolDir={d}/spool-%n
SlurmdPidFile={d}/slurmd-%n.pid
SlurmctldPidFile={d}/ctld.pid
SlurmctldLogFile={d}/slurmctld.log
SlurmdLogFile={d}/slurmd-%n.log
SlurmctldPort={ctld}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,bf_interval=1,sched_min_interval=0
ReturnToService=2
SlurmdTimeout=5
MinJobAge=3600
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={n1} CPUs={cpus} Sockets=1 CoresPerSocket={cpus} ThreadsPerCore=1 RealMemory=1000
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={n2} CPUs={cpus} Sockets=1 CoresPerSocket={cpus} ThreadsPerCore=1 RealMemory=1000
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE DefMemPerCPU=0 State=UP
"""


class Broken(Exception):
    pass


def tool(name):
    """The daemons are in sbin, which is not in everybody's PATH."""
    return shutil.which(name) or shutil.which(name, path="/usr/sbin:/sbin:/usr/local/sbin")


def missing():
    return [name for name in PROGRAMS if tool(name) is None]


def until(condition, what, deadline_s=READY_S):
    """Waits for something that comes; a deadline is a net against hanging, not a measure."""
    end, pause = time.monotonic() + deadline_s, threading.Event()
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > end:
            raise Broken(f"waited {deadline_s:.0f} s for {what}")
        pause.wait(0.05)


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    try:
        for s in sockets:
            s.bind(("127.0.0.1", 0))
        return [s.getsockname()[1] for s in sockets]
    finally:
        for s in sockets:
            s.close()


def processes():
    """(pid, parent, name, environment) of all processes that may be looked into."""
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
                stat = file.read()
            with open(f"/proc/{pid}/environ", "rb") as file:
                environment = file.read().split(b"\0")
        except OSError:
            continue
        name = stat[stat.index("(") + 1:stat.rindex(")")]
        yield int(pid), int(stat[stat.rindex(")") + 2:].split()[1]), name, environment


class Cluster:
    def __init__(self, cpus=1):
        self.cpus, self.daemons = cpus, {}

    def __enter__(self):
        # Paths of sockets are short.
        self.folder = tempfile.mkdtemp(prefix="kb-slurm-", dir="/tmp")
        self.mark = os.path.basename(self.folder)
        try:
            self.configure()
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for node in NODES:
            self.kill_jobs(node)
        for daemon in reversed(list(self.daemons.values())):
            daemon.terminate()
        for daemon in self.daemons.values():
            try:
                daemon.wait(END_S)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def configure(self):
        with open(self.path("key"), "wb") as file:
            file.write(os.urandom(128))
        os.chmod(self.path("key"), 0o400)
        os.mkdir(self.path("state"))
        for node in NODES:
            os.mkdir(self.path(f"spool-{node}"))
        ctld, n1, n2 = free_ports(3)
        with open(self.path("slurm.conf"), "w", encoding="utf-8") as file:
            file.write(CONF.format(host=socket.gethostname().split(".")[0], user=getpass.getuser(), d=self.folder, ctld=ctld, n1=n1, n2=n2,
                                   cpus=self.cpus))
        self.environment = {**os.environ, "SLURM_CONF": self.path("slurm.conf"), MARK: self.mark}

    def daemon(self, name, *command):
        with open(self.path(f"{name}.out"), "ab") as out:
            self.daemons[name] = subprocess.Popen([tool(command[0]), *command[1:]], stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                                  env=self.environment)

    def start(self):
        self.daemon("munged", "munged", "--foreground", "--force", f"--key-file={self.path('key')}", f"--socket={self.path('munge.sock')}",
                    f"--pid-file={self.path('munged.pid')}", f"--log-file={self.path('munged.log')}", f"--seed-file={self.path('munged.seed')}")
        until(lambda: os.path.exists(self.path("munge.sock")), "munged")
        self.daemon("slurmctld", "slurmctld", "-D", "-c", "-f", self.path("slurm.conf"))
        for node in NODES:
            self.start_node(node)
        until(lambda: all(self.state_of(node).startswith("IDLE") for node in NODES), f"the nodes; logs in {self.folder}")

    def start_node(self, node):
        self.daemon(node, "slurmd", "-D", "-N", node, "-f", self.path("slurm.conf"))

    def ask(self, *command):
        return subprocess.run([tool(command[0]), *command[1:]], env=self.environment, capture_output=True, text=True, check=False).stdout

    def state_of(self, node):
        words = dict(word.split("=", 1) for word in self.ask("scontrol", "-o", "show", "node", node).split() if "=" in word)
        return words.get("State", "")

    def processes_on(self, node):
        """Processes of jobs on a node, and the slurmstepd above them."""
        mine = [MARK.encode() + b"=" + self.mark.encode(), b"SLURMD_NODENAME=" + node.encode()]
        table = list(processes())
        steps = {pid for pid, _, name, _ in table if name.startswith("slurmstepd")}
        of_jobs = [(pid, parent, name) for pid, parent, name, environment in table if all(line in environment for line in mine)]
        return of_jobs, {parent for _, parent, _ in of_jobs} & steps

    def kill_jobs(self, node):
        of_jobs, steps = self.processes_on(node)
        for pid in [*steps, *(pid for pid, _, _ in of_jobs)]:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def kill_node(self, node):
        """As if its power had gone: the daemon, the steps and all that they run."""
        daemon = self.daemons.pop(node)
        daemon.kill()
        self.kill_jobs(node)
        daemon.wait()

    def restarts(self):
        """How often tasks of arrays were queued again."""
        words = self.ask("scontrol", "-o", "show", "job").split()
        return sum(int(word.split("=")[1]) for word in words if word.startswith("Restarts="))
