from tests.dropflow.report.conftest import results_folder, short_results, still_rows

__all__ = ["results_folder", "short_results", "still_rows"]
