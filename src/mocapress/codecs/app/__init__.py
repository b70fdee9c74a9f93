"""APP: the Alpha Parallelogram Predictor.

P. Wang, Z. Pan, M. Zhang, R. W. H. Lau, H. Song: "The alpha parallelogram predictor: A lossless
compression method for motion capture data", Information Sciences 232 (2013).
"""

from mocapress.codecs.app.codec import App
from mocapress.codecs.app.coding import Coding
from mocapress.codecs.app.measures import average_prediction_error, ideal_alphas
from mocapress.codecs.app.tables import ALPHA_TABLES

__all__ = ["ALPHA_TABLES", "App", "Coding", "average_prediction_error", "ideal_alphas"]
