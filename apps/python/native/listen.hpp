#pragma once
// One tap of a running stream.

#include <optional>
#include <string>

#include <pybind11/pybind11.h>

#include "apps/python/native/python_values.hpp"
#include "stream/wire/security/curve.hpp"

namespace hertzline::python {

/// The keys in these files, for an encrypted stream; none without files. @param own secret key @param server public key
std::optional<stream::CurveClient> keys_of(const std::optional<std::string>& own,
                                           const std::optional<std::string>& server, ArgumentFaults& faults);

void add_listen(pybind11::module_& module);

}  // namespace hertzline::python
