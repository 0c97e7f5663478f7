#include "studies/sweep/sweep_table.hpp"

namespace hertzline::studies {

recordings::Table empty_table(const Sweep& sweep) {
    recordings::Table table{columns_of(sweep), 0, sweep_provenance(sweep), records_name, {}, {}};
    if (sweep.demand.waveform) {
        const TapRow& row = hertzline::row_of(*sweep.demand.waveform);
        table.samples =
            recordings::TableSamples{std::string(row.name), std::string(row.unit), sweep.samples()};
    }
    return table;
}

recordings::Table table_of(const Sweep& sweep, std::span<const Journal> parts) {
    recordings::Table table = empty_table(sweep);
    table.rows = sweep.plan.size();
    table.read = [parts](std::int64_t point, recordings::TableRow& row) {
        parts[static_cast<std::size_t>(point) % parts.size()].read(point, row);
    };
    return table;
}

void load_rows(Journal& journal, const Sweep& sweep) {
    journal.load(columns_of(sweep), sweep.samples(), sweep.plan.size());
}

}  // namespace hertzline::studies
