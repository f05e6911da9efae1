"""A Dask cluster out of SLURM jobs, for `mpm sweep --scheduler`. Run it where jobs may be submitted, and leave it running: python slurm.py 100

It needs dask-jobqueue, and the environment of mpm at the same path on every node. Each job is one worker of one core; jobs that end at their wall time
are replaced while the script runs, and a sweep loses only what they were computing (with `--results shared`, back to the last checkpoint).
"""

import signal
import socket
import sys

from dask_jobqueue import SLURMCluster

PORT = 8786


def main() -> None:
    """Keep so many jobs, say where the scheduler is, and wait for Ctrl-C."""
    cluster = SLURMCluster(
        queue="compute",  # the partition
        cores=1,
        processes=1,
        memory="4GB",
        walltime="04:00:00",
        interface=None,  # the network that nodes share, as "ib0"
        job_script_prologue=["export MPM_CACHE_DIR=$HOME/.cache/mpm NUMBA_NUM_THREADS=1"],  # one compile cache for all
        scheduler_options={"port": PORT, "dashboard": False, "dashboard_address": "127.0.0.1:0"},
    )
    cluster.adapt(minimum_jobs=int(sys.argv[1]), maximum_jobs=int(sys.argv[1]))
    print(f"mpm sweep CONFIG --scheduler tcp://{socket.gethostname()}:{PORT} --results shared", flush=True)
    signal.pause()


if __name__ == "__main__":
    main()
