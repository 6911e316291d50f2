"""What the service costs: the wall time of a run through it over that of `dropflow analyse` of the same film and cores.

    python -m benchmarks.service_overhead [--frames 500]

The service is that of `make run` on a new folder, with its own Postgres and Valkey. Both analyse the film of the demo
with default parameters and as many processes as there are cores, after a short film that has the code compiled. The
time of a run is from its creation to its end by the clock of the database; frames were uploaded and indexed before.
The last line is the share by which the service takes longer: under 10 % is the aim at 500 frames.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from datetime import datetime
from pathlib import Path

import httpx

from deploy.local.demo import CONSTANTS, SCENARIO, SEED, send_demo
from deploy.local.folder import open_folder
from deploy.local.instance import Instance
from deploy.local.options import Options
from deploy.local.processes import free_port
from dropflow.analysis import available_processes
from dropflow.simulation.film import Film
from dropflow.simulation.scenario import changed, named_scenario
from dropflow.simulation.write import write_experiment

COMMAND = [sys.executable, "-c", "from dropflow.cli import main; main()"]
N_WARM_UP_FRAMES = 8
_OVER = {"completed", "failed", "cancelled"}


def command_s(n_frames: int, folder: Path) -> float:
    """Wall time of the command, s."""
    film = folder / "film"
    write_experiment(film, Film(changed(named_scenario(SCENARIO), CONSTANTS), SEED), n_frames)
    options = ["--experiment", film / "experiment.yaml", "--output", folder / "results"]
    began_s = time.perf_counter()
    jobs = ["--jobs", str(available_processes())]
    subprocess.run([*COMMAND, "analyse", film / "frames", *options, *jobs], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began_s


def service_s(client: httpx.Client, n_frames: int) -> float:
    """Wall time of the run of a new experiment, s."""
    experiment_id = send_demo(client, n_frames=n_frames)
    while (run := client.get(f"experiments/{experiment_id}/runs").json()["items"][0])["state"] not in _OVER:
        time.sleep(0.5)
    if run["state"] != "completed":
        sys.exit(f"The run ended {run['state']}: {run['problem']}")
    client.delete(f"runs/{run['id']}", params={"forever": True}).raise_for_status()
    client.delete(f"experiments/{experiment_id}", params={"forever": True}).raise_for_status()
    began, ended = (datetime.fromisoformat(run[name]) for name in ("created_at", "finished_at"))
    return (ended - began).total_seconds()


def main() -> None:
    """Measure both, print the ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=500)
    n_frames = parser.parse_args().frames
    with tempfile.TemporaryDirectory(prefix="dropflow-benchmark-") as scratch:
        command_s(N_WARM_UP_FRAMES, Path(scratch) / "warm")
        by_command_s = command_s(n_frames, Path(scratch) / "command")
        options = Options(port=free_port(), data=Path(scratch) / "service", has_demo=False)
        with open_folder(options) as folder, Instance(options, folder, print) as instance:
            instance.start()
            token = {"Authorization": f"Bearer {folder.program_token()}"}
            with httpx.Client(base_url=f"{options.address}api/v1/", headers=token, timeout=60) as client:
                service_s(client, N_WARM_UP_FRAMES)
                by_service_s = service_s(client, n_frames)
    print(f"dropflow analyse of {n_frames} frames: {by_command_s:.1f} s on {available_processes()} cores")
    print(f"a run of the service:           {by_service_s:.1f} s")
    print(f"overhead: {100 * (by_service_s / by_command_s - 1):+.0f} %")


if __name__ == "__main__":
    main()
