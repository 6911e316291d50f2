"""Results against ground truth. Each score is a pure function of tables that were matched once."""

from dropflow.scoring.detection import DetectionScore, score_detection
from dropflow.scoring.flow import FlowScore, FlowSteps, read_flow, score_flow
from dropflow.scoring.isbi import IsbiScore, score_isbi
from dropflow.scoring.links import LinkScore, score_links
from dropflow.scoring.matching import Matching, match_to_truth
from dropflow.scoring.report import Report, read_products, score_results
from dropflow.scoring.sizes import SizeScore, score_size_distribution

__all__ = [
    "DetectionScore",
    "FlowScore",
    "FlowSteps",
    "IsbiScore",
    "LinkScore",
    "Matching",
    "Report",
    "SizeScore",
    "match_to_truth",
    "read_flow",
    "read_products",
    "score_detection",
    "score_flow",
    "score_isbi",
    "score_links",
    "score_results",
    "score_size_distribution",
]
