"""Growing trees with scikit-learn, and taking them over as arrays."""

from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.trees import Trees

Column = npt.NDArray[np.float64]


def classifier_trees(features: Column, is_droplet: Column, weight: Column, *, n_trees: int, seed: int) -> Trees:
    """Trees whose sum is the log odds of being a droplet."""
    from sklearn.ensemble import HistGradientBoostingClassifier

    grown = HistGradientBoostingClassifier(
        max_iter=n_trees,
        learning_rate=14.0 / n_trees,
        max_leaf_nodes=16,
        min_samples_leaf=25,
        l2_regularization=2.0,
        random_state=seed,
    ).fit(features, is_droplet, sample_weight=weight)
    return taken_over(grown)


def regressor_trees(
    features: Column, target: Column, *, n_trees: int, seed: int, quantile: float | None = None
) -> Trees:
    """Trees whose sum is the median of the target, or another quantile of it."""
    from sklearn.ensemble import HistGradientBoostingRegressor

    loss: dict[str, Any] = (
        {"loss": "absolute_error"} if quantile is None else {"loss": "quantile", "quantile": quantile}
    )
    grown = HistGradientBoostingRegressor(
        max_iter=n_trees,
        learning_rate=9.0 / n_trees,
        max_leaf_nodes=12,
        min_samples_leaf=20,
        random_state=seed,
        **loss,
    ).fit(features, target)
    return taken_over(grown)


def taken_over(grown: Any) -> Trees:
    """The trees of a histogram gradient boosting model of scikit-learn."""
    parts: list[dict[str, Any]] = []
    roots, n_nodes = [], 0
    for (tree,) in grown._predictors:
        nodes = tree.nodes
        index = np.arange(len(nodes))
        is_leaf = nodes["is_leaf"].astype(bool)
        roots.append(n_nodes)
        n_nodes += len(nodes)
        parts.append(
            {
                "feature": np.where(is_leaf, -1, nodes["feature_idx"]),
                "threshold": np.where(is_leaf, 0, nodes["num_threshold"]),
                "left": np.where(is_leaf, 0, nodes["left"].astype(np.int64) - index),
                "right": np.where(is_leaf, 0, nodes["right"].astype(np.int64) - index),
                "missing_left": nodes["missing_go_to_left"].astype(bool),
                "value": np.where(is_leaf, nodes["value"], 0),
            }
        )
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return Trees(
        feature=joined["feature"].astype(np.int16),
        threshold=joined["threshold"].astype(np.float32),
        left=joined["left"].astype(np.int16),
        right=joined["right"].astype(np.int16),
        missing_left=joined["missing_left"],
        value=joined["value"].astype(np.float32),
        root=np.array(roots, np.int32),
        baseline=np.array([float(np.ravel(grown._baseline_prediction)[0])], np.float32),
    )


def scaled(trees: Trees, factor: float, shift: float) -> Trees:
    """Trees whose sum is `factor` times the sum of `trees` plus `shift`."""
    return Trees(
        trees.feature,
        trees.threshold,
        trees.left,
        trees.right,
        trees.missing_left,
        (trees.value * factor).astype(np.float32),
        trees.root,
        (trees.baseline * factor + shift).astype(np.float32),
    )
