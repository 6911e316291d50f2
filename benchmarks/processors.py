"""Seconds of processors, spent by a process and by a machine."""

import psutil


def spent_s(pid: int) -> float:
    """By a process and those it has started."""
    process = psutil.Process(pid)
    own = process.cpu_times()
    children = [child.cpu_times() for child in process.children(recursive=True)]
    ended = own.children_user + own.children_system
    return float(ended + sum(times.user + times.system for times in (own, *children)))


def machine_s() -> float:
    """By all that runs here."""
    times = psutil.cpu_times()
    return float(times.user + times.nice + times.system + times.irq + times.softirq)
