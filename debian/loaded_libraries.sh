#!/bin/sh
# loaded_libraries.sh FOLDER: prints the files of the libraries that the binaries in the folder load when they need them: no linker
# names them. The static libraries and the module load HDF5 and libsndfile, the program all of them.
set -eu
names=$(find "$1" -type f -exec grep -aohE 'lib(fftw3|hdf5_serial|nlopt_cxx|sndfile|sodium|sqlite3|zmq)\.so\.[0-9]+' {} + | sort -u)
case $names in
*hdf5*sndfile*) ;;
*) echo "loaded_libraries.sh: found '$names' in $1, expected HDF5 and libsndfile at least" >&2 && exit 1 ;;
esac
for name in $names; do
    echo "/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)/$name"
done
