#include "stream/recordings/formats/hdf5/hdf5_layout.hpp"

#include <algorithm>
#include <array>

namespace hertzline::stream {

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

}  // namespace hertzline::stream
