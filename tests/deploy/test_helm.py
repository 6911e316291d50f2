"""The chart as Helm and the schemas of Kubernetes see it. Helm is no Python package: without it these tests skip."""

import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.services import ROOT

CHART = ROOT / "deploy" / "helm" / "dropflow"
NEEDED = {"image.repository": "registry.example/dropflow", "secrets.name": "dropflow", "host": "dropflow.example.org"}
OWN = {"postgres.enabled": "true", "valkey.enabled": "true", "store.enabled": "true"}
VARIANTS: dict[str, dict[str, str]] = {
    "external servers": {},
    "own servers": OWN,
    "scaled by a metric": {"autoscaling.kind": "hpa"},
    "plain": {"ingress.tls": "false", "networkPolicies.enabled": "false", "podDisruptionBudgets.enabled": "false"},
    "watched": {"monitoring.dashboard": "true"},
    "kept": {"backup.enabled": "true", "backup.restore": "newest"},
}


def helm(*arguments: str, **values: str) -> subprocess.CompletedProcess[str]:
    program = shutil.which("helm") or shutil.which("helm", path=ROOT / ".venv" / "bin")
    if program is None:
        pytest.skip("no helm on the PATH: go install helm.sh/helm/v3/cmd/helm@latest")
    settings = [part for name, value in values.items() for part in ("--set", f"{name}={value}")]
    return subprocess.run([program, *arguments, *settings], capture_output=True, text=True)


def rendered(**values: str) -> list[dict[str, Any]]:
    done = helm("template", "lab", str(CHART), "--kube-version", "1.33.0", **NEEDED, **values)
    assert done.returncode == 0, done.stderr
    return [document for document in yaml.safe_load_all(done.stdout) if document]


def test_the_chart_has_no_faults() -> None:
    done = helm("lint", str(CHART), "--strict", "--kube-version", "1.33.0", **NEEDED)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("variant", VARIANTS)
def test_what_it_renders_is_valid_for_kubernetes(variant: str, tmp_path: Path) -> None:
    for number, document in enumerate(rendered(**VARIANTS[variant])):
        (tmp_path / f"{number}.yaml").write_text(yaml.safe_dump(document))
    done = subprocess.run(
        [ROOT / ".venv" / "bin" / "kubernetes-validate", "--strict", *sorted(tmp_path.iterdir())],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_container_is_closed_and_limited() -> None:
    kinds = {"Deployment", "StatefulSet", "Job"}
    workloads = [document for document in rendered(**OWN) if document["kind"] in kinds]
    assert len(workloads) == 10
    for workload in workloads:
        pod = workload["spec"]["template"]["spec"]
        assert pod["securityContext"]["runAsNonRoot"] is True
        assert pod["automountServiceAccountToken"] is False
        for container in (*pod.get("initContainers", ()), *pod["containers"]):
            security = container["securityContext"]
            assert security["readOnlyRootFilesystem"] is True
            assert security["capabilities"]["drop"] == ["ALL"]
            assert container["resources"]["limits"]["memory"]


def test_the_database_lets_in_whoever_may_come() -> None:
    def most(**values: str) -> int:
        (server,) = (
            d for d in rendered(**OWN, **values) if d["kind"] == "StatefulSet" and "postgres" in d["metadata"]["name"]
        )
        flag, setting = server["spec"]["template"]["spec"]["containers"][0]["args"]
        assert flag == "-c"
        return int(setting.removeprefix("max_connections="))

    few = most(**{"workers.shards.replicas": "1", "workers.shards.concurrency": "2"})
    assert most(**{"workers.shards.replicas": "11", "workers.shards.concurrency": "2"}) == few + 10 * (4 + 2 * 2)
    assert most(**{"autoscaling.kind": "hpa", "workers.shards.maxReplicas": "100"}) > 100 * (4 + 2 * 2)


def test_every_server_is_started_again_when_it_hears_nothing_any_more() -> None:
    deployments = [d for d in rendered() if d["kind"] == "Deployment" and "reconciler" not in d["metadata"]["name"]]
    assert len(deployments) == 5
    assert all(d["spec"]["template"]["spec"]["containers"][0]["livenessProbe"] for d in deployments)


def test_what_ours_do_goes_through_the_entrypoint_of_the_image() -> None:
    image = NEEDED["image.repository"]
    containers = [
        container
        for document in rendered(**OWN)
        if document["kind"] in {"Deployment", "Job"}
        for container in document["spec"]["template"]["spec"]["containers"]
    ]
    ours = [container for container in containers if container["image"].startswith(image)]
    assert len(ours) == 7
    assert all("args" in container and "command" not in container for container in ours)


@pytest.mark.parametrize(
    ("moment", "words"), [("newest", []), ("2026-11-22T10-00-00Z", ["--moment", "2026-11-22T10-00-00Z"])]
)
def test_a_backup_is_made_each_night_and_brought_back_when_it_is_asked_for(moment: str, words: list[str]) -> None:
    documents = rendered(**{"backup.enabled": "true", "backup.restore": moment})
    made = {document["kind"]: document for document in documents if "backup" in str(document)}
    assert set(made) == {"PersistentVolumeClaim", "CronJob", "Job"}
    pods = [made["CronJob"]["spec"]["jobTemplate"]["spec"]["template"]["spec"], made["Job"]["spec"]["template"]["spec"]]
    said = [["backup", "/backups"], ["restore", "/backups", *words]]
    for pod, arguments in zip(pods, said, strict=True):
        (container,) = pod["containers"]
        assert container["args"] == ["dropflow-server", *arguments]
        assert {"name": "backups", "mountPath": "/backups"} in container["volumeMounts"]
        assert container["securityContext"]["readOnlyRootFilesystem"] is True
    assert "backup" not in str(rendered())


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ({"image.repository": ""}, "/image/repository"),
        ({"host": ""}, "/host"),
        ({"secrets.name": ""}, "/secrets/name"),
        ({"image.tag": "latest"}, "/image/tag"),
        ({"workers.shards.concurrency": "0"}, "/workers/shards/concurrency"),
        ({"autoscaling.kind": "keda"}, "/autoscaling/redisAddress"),
        ({"settings.log_level": "DEBUG"}, "log_level"),
        ({"backup.restore": "newest"}, "/backup/enabled"),
    ],
)
def test_wrong_values_are_refused_with_their_name(values: dict[str, str], field: str) -> None:
    done = helm("template", "lab", str(CHART), "--kube-version", "1.33.0", **(NEEDED | values))
    assert done.returncode != 0
    assert field in done.stderr


def test_scaling_by_queue_length_asks_each_queue() -> None:
    made = rendered(**{"autoscaling.kind": "keda", "autoscaling.redisAddress": "queue.example:6379"})
    lists = {d["spec"]["triggers"][0]["metadata"]["listName"] for d in made if d["kind"] == "ScaledObject"}
    assert lists == {"shards", "sequential", "ingest", "interactive"}
    assert all(
        "replicas" not in d["spec"] for d in made if d["kind"] == "Deployment" and "worker" in d["metadata"]["name"]
    )
