"""Records: what results are called, and how they reach the disk.

variables.py   the one table of names, symbols, units, dimensions and long names (a leaf: any room may import it)
netcdf.py      groups of labelled arrays to the bytes of a NetCDF-4 file, and such bytes to disk, whole or not at all
point.py       a Run and its provenance to one point file, and back
checkpoint.py  what a run remembers to one file, and back, so that it goes on where it was killed

Further files
    batch    many small records in one sealed HDF5 file
    frames   the snapshots of one run in a file of their own, `<run id>.frames`, one after another as they are made
    large    datasets that are written piece by piece
    patterns names of variables that hold other names
"""
