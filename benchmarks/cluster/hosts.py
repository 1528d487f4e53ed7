"""Hosts with addresses, processes and temporary files of their own on one machine, by Linux namespaces; needs root.

A host is a process that holds the namespaces. If it is killed, all processes of the host end with it, and the system
closes their connections. If a cable is pulled (`Network.link`), the connections stay open.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

_HELD = "mount -t tmpfs none /dev/shm && mkdir -p /tmp/ray && mount -t tmpfs none /tmp/ray && exec sleep infinity"
_NETWORK = "10.77.0"


@dataclass(frozen=True)
class Host:
    number: int
    holder: subprocess.Popen[bytes]
    pid: int
    """Process id of the first process within the namespaces."""

    @property
    def address(self) -> str:
        return f"{_NETWORK}.{self.number}"

    def command(self, *words: str) -> list[str]:
        return ["nsenter", "--target", str(self.pid), "--net", "--mount", "--pid", "--uts", "--ipc", *words]

    def run(self, *words: str) -> None:
        subprocess.run(self.command(*words), check=True, capture_output=True, text=True)

    def kill(self) -> None:
        os.kill(self.pid, signal.SIGKILL)
        self.holder.wait()


class Network:
    """Hosts on one switch."""

    def __init__(self, hosts: int) -> None:
        self._switch = _holder("exec sleep infinity", "--net")
        self._in_switch("link", "add", "switch", "type", "bridge")
        self._in_switch("link", "set", "switch", "up")
        self.hosts = [self._host(number) for number in range(1, hosts + 1)]

    def link(self, host: Host, state: str) -> None:
        """Pull or plug in the cable of a host: `down` or `up`."""
        self._in_switch("link", "set", f"port{host.number}", state)

    def close(self) -> None:
        for host in self.hosts:
            if host.holder.poll() is None:
                host.kill()
        self._switch.kill()
        self._switch.wait()

    def _host(self, number: int) -> Host:
        holder = _holder(_HELD, "--net", "--mount", "--pid", "--uts", "--ipc", "--fork", "--kill-child", "--mount-proc")
        host = Host(number, holder, _child(holder.pid))
        self._in_switch("link", "add", f"port{number}", "type", "veth", "peer", "name", "eth0", "netns", str(host.pid))
        self._in_switch("link", "set", f"port{number}", "master", "switch", "up")
        host.run("hostname", f"host{number}")
        host.run("ip", "address", "add", f"{host.address}/24", "dev", "eth0")
        for device in ("lo", "eth0"):
            host.run("ip", "link", "set", device, "up")
        return host

    def _in_switch(self, *words: str) -> None:
        inside = ["nsenter", "--target", str(self._switch.pid), "--net", "ip", *words]
        subprocess.run(inside, check=True, capture_output=True, text=True)


def exit_without_namespaces() -> None:
    """Exit with a message if this machine cannot create hosts."""
    missing = [name for name in ("ip", "nsenter", "setpriv", "unshare") if shutil.which(name) is None]
    if missing:
        sys.exit(f"{', '.join(missing)}: not found; apt-get install -y iproute2 util-linux")
    words = ["unshare", "--net", "--mount", "--pid", "--fork", "ip", "link", "add", "name", "one", "type", "veth"]
    tried = subprocess.run(words, capture_output=True, text=True, check=False)
    if tried.returncode:
        sys.exit(f"hosts need root, namespaces and veth of Linux: {tried.stderr.strip()}")


def _holder(program: str, *namespaces: str) -> subprocess.Popen[bytes]:
    """Return a process in separate namespaces, once it is ready."""
    with_us = ["setpriv", "--pdeathsig", "KILL"]
    inside = [*with_us, "unshare", *namespaces, "sh", "-c", program]
    holder = subprocess.Popen(inside, stderr=subprocess.DEVNULL)
    pid = _child(holder.pid) if "--fork" in namespaces else holder.pid
    _wait(lambda: Path(f"/proc/{pid}/cmdline").read_bytes().startswith(b"sleep"))
    return holder


def _child(pid: int) -> int:
    children = Path(f"/proc/{pid}/task/{pid}/children")
    _wait(children.read_text)
    return int(children.read_text().split()[0])


def _wait(condition) -> None:  # noqa: ANN001 - of a script
    end = time.monotonic() + 10
    while not condition():
        if time.monotonic() > end:
            sys.exit("a host does not start")
        time.sleep(0.01)
