"""The trained model that comes with the package, and the trees in it."""

import numpy as np
import pytest

from dropflow.detection.default.features import FEATURES
from dropflow.detection.default.model import AGAIN, MODEL_FILE, default_model, load
from dropflow.detection.default.training.growing import classifier_trees, regressor_trees, scaled

MAX_BYTES = 300_000


@pytest.fixture(scope="module")
def rows():
    """Features of which the second decides, with some missing."""
    # Multiples of 1/64: what lies between two of them is exact in float32 too.
    features = np.rint(np.random.default_rng(0).normal(size=(800, 4)) * 64) / 64
    features[::7, 2] = np.nan
    return features


def test_the_model_is_small_and_says_how_it_was_trained():
    about = default_model().about
    assert MODEL_FILE.stat().st_size < MAX_BYTES
    assert about["n_droplets"] > 5000
    assert about["syllabus"].keys() == {"films", "backlit", "discs", "empty"}


def test_a_model_survives_being_stored(tmp_path):
    model, features = default_model(), np.random.default_rng(0).normal(size=(50, len(AGAIN)))
    model.save(tmp_path / "model.npz")
    read = load(tmp_path / "model.npz")
    for part in ("again", "radius", "radius_error", "position_error"):
        assert (getattr(read, part).predict(features) == getattr(model, part).predict(features)).all()
    assert read.about["n_droplets"] == model.about["n_droplets"]


def test_a_model_of_other_features_is_refused(tmp_path, monkeypatch):
    default_model().save(tmp_path / "model.npz")
    monkeypatch.setattr("dropflow.detection.default.model.AGAIN", FEATURES)
    with pytest.raises(ValueError, match="trained on other features"):
        load(tmp_path / "model.npz")


def test_features_beyond_the_training_are_counted():
    model = default_model()
    usual = np.tile((model.low + model.high) / 2, (5, 1))
    assert model.share_out_of_range(usual) == 0
    usual[:, : len(AGAIN) // 2] += 1e6
    assert model.share_out_of_range(usual) == pytest.approx(0.5, abs=0.02)
    assert model.share_out_of_range(usual[:0]) == 0


def test_trees_taken_over_predict_what_the_library_does(rows):
    """The library's own answer is the log odds; missing values go their own way."""
    from sklearn.ensemble import HistGradientBoostingClassifier

    label = (rows[:, 1] > 0).astype(float)
    trees = classifier_trees(rows, label, np.ones(len(rows)), n_trees=20, seed=0)
    grown = HistGradientBoostingClassifier(
        max_iter=20,
        learning_rate=0.7,
        max_leaf_nodes=16,
        min_samples_leaf=25,
        l2_regularization=2.0,
        random_state=0,
    ).fit(rows, label)
    assert trees.predict(rows) == pytest.approx(grown.decision_function(rows), abs=1e-4)


def test_quantile_trees_give_the_quantile(rows):
    target = np.random.default_rng(1).exponential(size=len(rows))
    trees = regressor_trees(rows, target, n_trees=10, seed=0, quantile=0.7)
    assert np.mean(target < trees.predict(rows)) == pytest.approx(0.7, abs=0.05)


def test_scaled_trees_are_scaled_sums(rows):
    trees = regressor_trees(rows, rows[:, 0], n_trees=5, seed=0)
    assert scaled(trees, -2.0, 3.0).predict(rows) == pytest.approx(3 - 2 * trees.predict(rows), abs=1e-5)
