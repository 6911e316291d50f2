"""placeholder"""
import numpy as np
def position_std_px(r): return .1*r
def radius_std_px(r): return .1*r
def probability(m): return m/(m+.5)
