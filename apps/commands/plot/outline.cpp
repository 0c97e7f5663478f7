#include "apps/commands/plot/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hertzline::app {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Outline::Outline(std::vector<std::size_t> columns, std::size_t of)
    : columns_(std::move(columns)), of_(of), low_(columns_.size()), high_(columns_.size()) {}

void Outline::take(std::int64_t first, std::span<const double> rows) {
    if (rows.empty()) {
        return;
    }
    first_ = empty() ? first : first_;
    take_part(first, rows);
    const auto end = first + static_cast<std::int64_t>(rows.size() / of_);
    while ((end - 1 - first_) / width_ >= static_cast<std::int64_t>(max_stretches)) {
        widen();
    }
    while (first < end) {
        const std::int64_t stretch = (first - first_) / width_;
        const std::int64_t count = std::min(end - first, width_ - (first - first_) % width_);
        const std::size_t numbers = static_cast<std::size_t>(count) * of_;
        take_stretch(static_cast<std::size_t>(stretch), rows.first(numbers));
        rows = rows.subspan(numbers);
        first += count;
    }
    end_ = end;
}

void Outline::take_stretch(std::size_t stretch, std::span<const double> rows) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        if (low_[i].size() <= stretch) {
            low_[i].resize(stretch + 1, none);
            high_[i].resize(stretch + 1, none);
        }
        double low = std::isnan(low_[i][stretch]) ? rows[columns_[i]] : low_[i][stretch];
        double high = std::isnan(high_[i][stretch]) ? low : high_[i][stretch];
        for (std::size_t at = columns_[i]; at < rows.size(); at += of_) {
            low = std::min(low, rows[at]);
            high = std::max(high, rows[at]);
        }
        low_[i][stretch] = low;
        high_[i][stretch] = high;
    }
}

/// Two stretches become one.
void Outline::widen() {
    const auto halve = [](std::vector<double>& values, auto choose) {
        const std::size_t count = (values.size() + 1) / 2;
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = choose(values[2 * i], 2 * i + 1 < values.size() ? values[2 * i + 1] : none);
        }
        values.resize(count);
    };
    for (std::size_t i = 0; i < columns_.size(); ++i) {  // of a number and NaN these choose the number
        halve(low_[i], [](double a, double b) { return std::fmin(a, b); });
        halve(high_[i], [](double a, double b) { return std::fmax(a, b); });
    }
    width_ *= 2;
}

void Outline::take_part(std::int64_t first, std::span<const double> rows) {
    constexpr std::size_t max_numbers = 8 * max_spectrum_rows;  // a map of many spheres shows no spectrum
    const std::size_t most = std::min(max_spectrum_rows, max_numbers / columns_.size()) * columns_.size();
    if (empty() || first != end_) {  // behind a gap
        if (part_.rows.size() > longest_.rows.size()) {
            std::swap(part_, longest_);
        }
        part_ = {first, {}};
    }
    for (std::size_t row = 0; row < rows.size() && part_.rows.size() < most; row += of_) {
        for (const std::size_t column : columns_) {
            part_.rows.push_back(rows[row + column]);
        }
    }
}

}  // namespace hertzline::app
