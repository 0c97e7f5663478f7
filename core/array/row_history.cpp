#include "core/array/row_history.hpp"

#include <algorithm>

namespace hertzline {

void RowHistory::put(std::int64_t row, const double* values) noexcept {
    const std::size_t at = static_cast<std::size_t>(row) % rows_;
    std::copy_n(values, numbers_, values_.data() + at * numbers_);
    std::copy_n(values, numbers_, values_.data() + (at + rows_) * numbers_);
}

Eigen::Map<const Eigen::VectorXd> RowHistory::up_to(std::int64_t row, std::int64_t count) const noexcept {
    const auto rows = static_cast<std::int64_t>(rows_);
    const std::int64_t end = (row % rows + rows) % rows + rows;
    return {values_.data() + static_cast<std::size_t>(end - count + 1) * numbers_,
            static_cast<Eigen::Index>(static_cast<std::size_t>(count) * numbers_)};
}

}  // namespace hertzline
