#pragma once
// The functions of the HDF5 library that recordings use, loaded when the first HDF5 file is opened. The library
// brings two dozen others; linked, they would take two thirds of the start of every program.
//
// The names are HDF5's own. In this namespace they are pointers, so that code reads as if the library were linked;
// names that are not listed here do not link.

#include <hdf5.h>

// clang-format off
#define HERTZLINE_HDF5_FUNCTIONS(X) \
    X(H5Aclose) X(H5Acreate2) X(H5Aget_space) X(H5Aget_type) X(H5Aopen) X(H5Aread) X(H5Awrite) \
    X(H5Dclose) X(H5Dcreate2) X(H5Dget_create_plist) X(H5Dget_space) X(H5Dget_storage_size) \
    X(H5Dget_type) X(H5Dopen2) X(H5Dread) X(H5Dset_extent) X(H5Dwrite) X(H5Eget_auto2) X(H5Eset_auto2) \
    X(H5Ewalk2) X(H5FDclose) X(H5FDopen) X(H5FDregister) X(H5Fclose) X(H5Fcreate) X(H5Fflush) X(H5Fopen) \
    X(H5Gget_info) X(H5Tget_member_name) X(H5Tget_nmembers) \
    X(H5Lget_info) X(H5Pclose) X(H5Pcreate) X(H5Pget_chunk) X(H5Pget_layout) X(H5Pget_nfilters) \
    X(H5Pset_chunk) X(H5Pset_deflate) X(H5Pset_driver) X(H5Pset_fapl_sec2) X(H5Pset_obj_track_times) \
    X(H5Pset_shuffle) X(H5Sclose) X(H5Screate) X(H5Screate_simple) \
    X(H5Sget_simple_extent_dims) X(H5Sget_simple_extent_ndims) X(H5Sget_simple_extent_npoints) \
    X(H5Sselect_hyperslab) X(H5Tclose) X(H5Tcopy) X(H5Tcreate) X(H5Tequal) X(H5Tget_size) \
    X(H5Tinsert) X(H5Tis_variable_str) \
    X(H5Tset_cset) X(H5Tset_size) X(H5check_version) X(H5free_memory) X(H5open)

/// Values of HDF5's names of types and classes, known once the library is open.
#define HERTZLINE_HDF5_NUMBERS(X) \
    X(H5P_CLS_DATASET_CREATE_ID_g) X(H5P_CLS_FILE_ACCESS_ID_g) X(H5T_C_S1_g) X(H5T_IEEE_F32LE_g) \
    X(H5T_IEEE_F64LE_g) X(H5T_NATIVE_DOUBLE_g) X(H5T_NATIVE_INT64_g) X(H5T_NATIVE_UCHAR_g) X(H5T_STD_I64LE_g) \
    X(H5T_STD_U8LE_g)
// clang-format on

namespace hertzline::recordings {

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
#define HERTZLINE_DECLARE(name) inline decltype(&::name) name = nullptr;
HERTZLINE_HDF5_FUNCTIONS(HERTZLINE_DECLARE)
#undef HERTZLINE_DECLARE
#define HERTZLINE_DECLARE(name) inline hid_t name = -1;
HERTZLINE_HDF5_NUMBERS(HERTZLINE_DECLARE)
#undef HERTZLINE_DECLARE
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

/// Sets them; does nothing from the second time on. One thread at a time.
/// @throws std::runtime_error when the library is not there
void load_hdf5();

}  // namespace hertzline::recordings
