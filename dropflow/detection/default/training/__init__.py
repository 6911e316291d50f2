"""How the model of the `default` detection is trained: ``python -m dropflow.detection.default.training``.

Needs scikit-learn, which the detection itself does not.
"""
