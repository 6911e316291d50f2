"""What alerts and dashboard ask for is what the service measures."""

import json
import re

import yaml
from prometheus_client import generate_latest

from backend.operations.measures import ServiceCollector
from backend.platform.measures import Measures
from tests.house import House
from tests.services import ROOT

MONITORING = ROOT / "deploy" / "helm" / "dropflow" / "monitoring"


def asked_for(text: str) -> set[str]:
    return {re.sub(r"_(bucket|count|total)$", "", name) for name in re.findall(r"\bdropflow_[a-z0-9_]+", text)}


def measured(house: House) -> set[str]:
    measures, platform = Measures(), house.app.state.platform
    measures.registry.register(ServiceCollector(platform.sessions, platform.queue))
    text = generate_latest(measures.registry).decode()
    return {re.sub(r"_total$", "", name) for name in re.findall(r"^# TYPE (\S+)", text, re.MULTILINE)}


def test_every_measure_of_alerts_and_dashboard_exists(house: House) -> None:
    alerts = yaml.safe_load((MONITORING / "alerts.yaml").read_text())
    expressions = [rule["expr"] for group in alerts["groups"] for rule in group["rules"]]
    panels = json.loads((MONITORING / "dashboard.json").read_text())["panels"]
    expressions += [target["expr"] for panel in panels for target in panel["targets"]]
    there = measured(house)
    assert len(there) > 10
    for expression in expressions:
        assert asked_for(expression), expression
        assert asked_for(expression) <= there, expression


def test_alerts_say_what_is_the_matter() -> None:
    alerts = yaml.safe_load((MONITORING / "alerts.yaml").read_text())
    for rule in alerts["groups"][0]["rules"]:
        assert rule["annotations"]["summary"].endswith(".")
        assert rule["labels"]["severity"] in {"warning", "critical"}
