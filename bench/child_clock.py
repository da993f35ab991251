"""What a child process took: its CPU seconds and the clock's."""
import resource
import subprocess
import time


def run_timed(command):
    """(CPU seconds of all its threads, seconds by the clock) of a command that must succeed."""
    def spent():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before, start = spent(), time.perf_counter()
    subprocess.run(command, check=True)
    return spent() - before, time.perf_counter() - start
