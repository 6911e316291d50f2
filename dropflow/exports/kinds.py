"""The forms in which results can be exported, and what each is called."""

from enum import StrEnum


class Kind(StrEnum):
    """One form of export."""

    CSV = "csv"
    """Trajectories as CSV; the first lines, which begin with #, hold the provenance."""
    PARQUET = "parquet"
    """Trajectories as Parquet with the provenance in the metadata."""
    HDF5 = "hdf5"
    """Droplets, trajectories and flow in one HDF5 file."""
    TRACKMATE = "trackmate"
    """Trajectories as TrackMate XML."""
    TRACKPY = "trackpy"
    """CSV with the columns of trackpy and pandas: frame, particle, x, y, size, mass."""
    NAPARI = "napari"
    """CSV of napari's tracks layer: track_id, t, y, x."""
    NETCDF = "netcdf"
    """The flow field as NetCDF 4."""
    ZARR = "zarr"
    """The flow field as a Zarr group."""


SUFFIX = {
    Kind.CSV: ".csv",
    Kind.PARQUET: ".parquet",
    Kind.HDF5: ".h5",
    Kind.TRACKMATE: ".xml",
    Kind.TRACKPY: ".csv",
    Kind.NAPARI: ".csv",
    Kind.NETCDF: ".nc",
    Kind.ZARR: ".zarr",
}
"""How the names of files of each kind end."""

MEDIA_TYPE = {
    Kind.CSV: "text/csv",
    Kind.PARQUET: "application/vnd.apache.parquet",
    Kind.HDF5: "application/x-hdf5",
    Kind.TRACKMATE: "application/xml",
    Kind.TRACKPY: "text/csv",
    Kind.NAPARI: "text/csv",
    Kind.NETCDF: "application/x-netcdf",
    Kind.ZARR: "application/zip",
}
TITLE = {
    Kind.CSV: "Trajectories as CSV",
    Kind.PARQUET: "Trajectories as Parquet",
    Kind.HDF5: "Droplets, trajectories and flow as HDF5",
    Kind.TRACKMATE: "Trajectories as TrackMate XML",
    Kind.TRACKPY: "Trajectories as trackpy and pandas take them",
    Kind.NAPARI: "Trajectories as napari's tracks",
    Kind.NETCDF: "Flow field as NetCDF",
    Kind.ZARR: "Flow field as Zarr, zipped",
}
