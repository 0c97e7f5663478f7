#include "recordings/formats/hdf5/hdf5_layout.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

namespace hertzline::recordings {

std::vector<Hdf5Quantity> hdf5_quantities(const RecordingHead& head) {
    std::vector<Hdf5Quantity> quantities;
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
        const Column& column = head.columns[i];
        auto found = std::ranges::find(quantities, column.quantity, &Hdf5Quantity::name);
        if (found == quantities.end()) {
            found = quantities.insert(
                found, {column.quantity, column.unit, {}, column.quantity.ends_with("_chain")});
        }
        found->columns.push_back(i);
        found->of_spheres = found->of_spheres || found->columns.size() > 1;
    }
    return quantities;
}

hid_t hdf5_type(NumberType numbers) {
    return numbers == NumberType::float32 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
}

Hdf5Rows::Hdf5Rows(hid_t dataset, std::int64_t row, std::int64_t rows)
    : file(H5Dget_space(dataset), H5Sclose) {
    std::array<hsize_t, 2> size{};
    const int rank = hdf5(H5Sget_simple_extent_dims(file.id(), size.data(), nullptr));
    const std::array<hsize_t, 2> from{static_cast<hsize_t>(row), 0};
    size[0] = static_cast<hsize_t>(rows);
    hdf5(H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr));
    memory = Hdf5Object(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
}

void hdf5_write_text(hid_t object, const char* name, const std::string& text) {
    const Hdf5Object type = hdf5_text_type();
    const Hdf5Object space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Object attribute(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    const char* const characters = text.c_str();
    hdf5(H5Awrite(attribute.id(), type.id(), &characters));
}

std::string hdf5_read_text(hid_t object, const char* name) {
    const Hdf5Object attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Object type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Object space(H5Aget_space(attribute.id()), H5Sclose);
    if (hdf5(H5Tis_variable_str(type.id())) == 0 || H5Sget_simple_extent_npoints(space.id()) != 1) {
        throw std::runtime_error(fmt::format("attribute {} is not a string", name));
    }
    char* characters = nullptr;
    hdf5(H5Aread(attribute.id(), hdf5_text_type().id(), &characters));
    std::string text = characters != nullptr ? characters : "";
    H5free_memory(characters);
    return text;
}

Hdf5Object hdf5_create_dataset(hid_t file, const std::string& name, hid_t type, int rank, hsize_t columns,
                               std::array<hsize_t, 2> chunk) {
    const std::array<hsize_t, 2> none{0, columns};
    const std::array<hsize_t, 2> most{H5S_UNLIMITED, columns};
    const Hdf5Object space(H5Screate_simple(rank, none.data(), most.data()), H5Sclose);
    const Hdf5Object properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    hdf5(H5Pset_chunk(properties.id(), rank, chunk.data()));
    return {H5Dcreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
            H5Dclose};
}

void hdf5_append_rows(hid_t dataset, hid_t type, std::int64_t row, std::int64_t rows, std::size_t columns,
                      const void* values) {
    const std::array<hsize_t, 2> size{static_cast<hsize_t>(row + rows), columns};
    hdf5(H5Dset_extent(dataset, size.data()));
    const Hdf5Rows part(dataset, row, rows);
    hdf5(H5Dwrite(dataset, type, part.memory.id(), part.file.id(), H5P_DEFAULT, values));
}

}  // namespace hertzline::recordings
