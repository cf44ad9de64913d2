"""Runs a command and measures what its process alone used, so that other work on the machine counts little."""

import os
import subprocess


class Finished:
    """A command that ended: code (of exit), told (what it wrote, errors included), user and system (s of processor)."""

    def __init__(self, code, told, usage):
        self.code, self.told = code, told
        self.user, self.system = usage.ru_utime, usage.ru_stime

    def last_line(self):
        return (self.told.strip().splitlines() or [""])[-1]


def timed_run(command, environment=None):
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment) as process:
        told = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return Finished(process.returncode, told, usage)
