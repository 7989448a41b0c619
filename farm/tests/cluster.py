# SPDX-License-Identifier: Apache-2.0
"""A Slurm cluster on this machine alone, for tests: one controller and some compute daemons in a folder of their own, without
systemd, cgroups or a database.

    farm/tests/cluster.py FOLDER [NODES]     starts one, tells what its clients need, and ends it with the standard input

Needs slurmctld, slurmd, slurm-client and munge; runs as root or as a plain user, whose jobs alone run then.
"""

import contextlib
import os
import pathlib
import pwd
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

PROGRAMS = ("munged", "munge", "slurmctld", "slurmd", "sbatch", "scontrol")
PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"

CONF = """\
ClusterName=farm
SlurmctldHost={host}({address})
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
AuthType=auth/munge
# an item that comes again waits so long and a second; less is refused
AuthInfo=socket={folder}/munge/socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/run/slurmctld.pid
SlurmdPidFile={folder}/run/%n.pid
SlurmctldLogFile={folder}/log/slurmctld.log
SlurmdLogFile={folder}/log/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
MailProg=/bin/true
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval=1,default_queue_depth=1000
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
# two arrays of 64 items
MaxArraySize=41
MinJobAge=600
KillWait=2
ReturnToService=2
SlurmdTimeout={dead}
SlurmctldTimeout=10
BatchStartTimeout={patience}
MessageTimeout={patience}
UnkillableStepTimeout=10
# CPUs that are not there are taken for there
SlurmdParameters=config_overrides
PropagateResourceLimits=NONE
{nodes}
PartitionName=main Nodes=node[1-{count}] Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""


def why_not():
    """What is missing for a cluster here, or ""."""
    missing = [name for name in PROGRAMS if not shutil.which(name, path=PATH)]
    if missing:
        return f"not installed: {', '.join(missing)} (apt-get install --no-install-recommends slurmctld slurmd slurm-client munge)"
    try:
        pwd.getpwuid(os.getuid())
        address = socket.gethostbyname(socket.gethostname())
    except KeyError:
        return "this user has no name, and Slurm needs one"
    except OSError as error:
        return f"this machine's name has no address: {error}"
    return "" if address.startswith("127.") else f"this machine's name is {address}, on which Slurm would listen for all; a test wants a loopback address"


def _wait_for(seconds, happens, what):
    end = time.monotonic() + seconds
    while not happens():
        if time.monotonic() > end:
            raise RuntimeError(f"{what}: not after {seconds} s")
        time.sleep(0.05)


def _free_ports(address, count):
    for first in range(20000 + os.getpid() % 8000, 32000, count):
        with contextlib.ExitStack() as stack:
            try:
                for port in range(first, first + count):
                    stack.enter_context(socket.socket()).bind((address, port))
            except OSError:
                continue
            return first
    raise RuntimeError("no free ports")


class Cluster:
    """dead: seconds after which a daemon that does not answer is taken for dead. A busy machine's may not for long."""

    def __init__(self, folder, nodes=4, cpus=16, dead=300):
        self.folder = pathlib.Path(folder).resolve()
        assert len(str(self.folder)) < 90 and re.fullmatch(r"[\w./+-]+", str(self.folder), re.A), "a socket's path is short and plain"
        self.nodes = [f"node{k + 1}" for k in range(nodes)]
        for name in ("etc", "munge", "run", "log", "spool", "state", *(f"spool/{node}" for node in self.nodes)):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        for place in (self.folder, *(self.folder / name for name in ("etc", "munge", "run", "log", "spool"))):
            place.chmod(0o755)
        host = socket.gethostname()
        address = socket.gethostbyname(host)  # on which the daemons listen
        port = _free_ports(address, 1 + nodes)
        lines = [f"NodeName={node} NodeHostname={node} NodeAddr={address} Port={port + 1 + k} CPUs={cpus} RealMemory=1000 State=UNKNOWN"
                 for k, node in enumerate(self.nodes)]
        self.conf = self.folder / "etc/slurm.conf"
        self.conf.write_text(CONF.format(host=host, address=address, port=port, user=pwd.getpwuid(os.getuid()).pw_name, folder=self.folder,
                                         dead=dead, patience=max(5, dead // 5), nodes="\n".join(lines), count=nodes))
        version = int(re.search(r"\d+", subprocess.run(["slurmctld", "-V"], capture_output=True, text=True, env={"PATH": PATH}).stdout)[0])
        (self.folder / "etc/cgroup.conf").write_text(f"CgroupPlugin={'disabled' if version >= 24 else 'cgroup/v1'}\n")
        # what tells these processes from all others
        self.environment = {**os.environ, "PATH": PATH, "SLURM_CONF": str(self.conf)}

    def run(self, *words, check=True):
        return subprocess.run(words, env=self.environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", check=check, timeout=60).stdout

    def _daemon(self, *words):
        with open(self.folder / "log/start.out", "ab") as out:
            subprocess.run(words, env=self.environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out, check=True, timeout=60)

    def start(self):
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        place = self.folder / "munge"
        self._daemon("munged", "--force", f"--key-file={key}", f"--socket={place}/socket", f"--pid-file={self.folder}/run/munged.pid",
                     f"--seed-file={place}/seed", f"--log-file={self.folder}/log/munged.log")
        self.start_controller()
        for node in self.nodes:
            self.start_node(node)
        _wait_for(120, lambda: self.run("sinfo", "-h", "-N", "-o", "%T").split() == ["idle"] * len(self.nodes), "idle nodes")

    def start_controller(self):
        self._daemon("slurmctld", "-f", str(self.conf))
        _wait_for(60, lambda: "is UP" in self.run("scontrol", "ping", check=False), "slurmctld's answer")

    def start_node(self, node):
        self._daemon("slurmd", "-f", str(self.conf), "-N", node)

    def pid(self, name):
        """Of munged, slurmctld or a node's daemon."""
        return int((self.folder / f"run/{name}.pid").read_text())

    def kill(self, name, how=signal.SIGKILL):
        os.kill(self.pid(name), how)

    def processes(self):
        """All of this cluster, and of its jobs: {pid: command line}."""
        found = {}
        for place in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                words = (place / "cmdline").read_bytes().decode(errors="replace").replace("\0", " ")
                if f"SLURM_CONF={self.conf}" in (place / "environ").read_bytes().decode(errors="replace").split("\0") and int(place.name) != os.getpid():
                    found[int(place.name)] = words
            except OSError:
                pass
        return found

    def steps(self, node):
        """Those that run jobs on a node: their slurmstepd."""
        return [pid for pid, words in self.processes().items() if words.startswith("slurmstepd:") and f"/{node}/" in self._open_files(pid)]

    @staticmethod
    def _open_files(pid):
        found = []
        for one in pathlib.Path(f"/proc/{pid}/fd").glob("*"):
            with contextlib.suppress(OSError):
                found.append(os.readlink(one))
        return " ".join(found).replace(".log", "/")

    def stop(self):
        """All of it, jobs too; twice does no harm."""
        for how in (signal.SIGTERM, signal.SIGKILL, signal.SIGKILL):
            for pid in self.processes():
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, how)
            end = time.monotonic() + 5
            while self.processes() and time.monotonic() < end:
                time.sleep(0.05)

    def __enter__(self):
        try:
            self.start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()


def main(folder, nodes="4"):
    if why_not():
        sys.exit(why_not())
    with Cluster(folder, int(nodes)) as cluster:
        print(f"export SLURM_CONF={cluster.conf}", flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
