"""Gaussian filters in real space against the Fourier filter that section 3.1.1 describes."""

import numpy as np
import pytest

from dropflow.preprocess import Blur, band_pass, smooth


def fourier_band_pass(image, index_x, index_y, low):
    """The definition, on a frame mirrored at its borders."""
    rows, columns = image.shape
    mirrored = np.pad(image, ((rows // 2, rows // 2), (columns // 2, columns // 2)), mode="symmetric").astype(float)
    v = np.fft.fftfreq(mirrored.shape[0])[:, None] * rows
    u = np.fft.fftfreq(mirrored.shape[1])[None, :] * columns
    high_pass = 1 - np.exp(-(u**2) / (2 * index_x**2) - v**2 / (2 * index_y**2))
    low_pass = np.exp(-(u**2 + v**2) / (2 * low**2))
    filtered = np.fft.ifft2(np.fft.fft2(mirrored) * high_pass * low_pass).real
    return filtered[rows // 2 : rows // 2 + rows, columns // 2 : columns // 2 + columns]


@pytest.mark.parametrize(("index_x", "index_y", "low"), [(5, 40, 20), (2, 12, 6)])
def test_band_pass_is_the_fourier_filter(index_x, index_y, low):
    """The error is below half a percent of the levels, for narrow blurs and for ones done on a reduced frame."""
    rng = np.random.default_rng(0)
    rows, columns = np.indices((240, 320))
    image = (40 + 0.1 * rows + 100 * (np.hypot(columns - 150, rows - 100) < 20) + rng.normal(0, 3, rows.shape)).astype(
        np.float32
    )
    high_pass = Blur.from_fourier(image.shape, index_x, index_y)
    low_pass = Blur.from_fourier(image.shape, low, low)
    filtered = band_pass(image, high_pass=high_pass, low_pass=low_pass)
    error = filtered - fourier_band_pass(image, index_x, index_y, low)
    assert filtered.dtype == np.float32
    assert np.abs(error).max() < 0.5


def test_band_pass_removes_stripes_along_x_but_keeps_a_droplet():
    rows, columns = np.indices((200, 400), np.float32)
    stripes = 20 * np.sin(rows / 7)
    droplet = 100 * (np.hypot(columns - 200, rows - 100) < 8).astype(np.float32)
    blurs = {"high_pass": Blur(60, 1), "low_pass": Blur(1, 1)}
    assert np.abs(band_pass(stripes, **blurs)).max() < 1
    assert band_pass(stripes + droplet, **blurs)[100, 200] > 80


@pytest.mark.parametrize("sigma", [0.8, 3.0, 8.0, 40.0])
def test_smoothing_spreads_a_point_by_its_sigma(sigma):
    """The standard deviation of the blurred point is the one asked for, reduced frame or not."""
    image = np.zeros((401, 403), np.float32)
    image[200, 201] = 1000
    blurred = smooth(image, Blur(sigma, 2.0)).astype(float)
    columns = np.arange(403)
    profile = blurred.sum(axis=0) / blurred.sum()
    assert np.sqrt(profile @ (columns - profile @ columns) ** 2) == pytest.approx(sigma, rel=0.03)
    assert profile @ columns == pytest.approx(201, abs=0.02)
    assert blurred.sum() == pytest.approx(1000, rel=1e-3)


def test_a_constant_frame_stays_constant():
    image = np.full((50, 70), 37.5, np.float32)
    assert smooth(image, Blur(30, 2)) == pytest.approx(37.5, rel=1e-5)
