#pragma once

#include <sys/resource.h>

namespace hertzline::test {

/// A limit of the system, for programs started during its lifetime.
class Limit {
public:
    Limit(__rlimit_resource resource, rlim_t limit) : resource_(resource) {
        getrlimit(resource_, &before_);
        const rlimit lowered{limit, before_.rlim_max};
        setrlimit(resource_, &lowered);
    }
    ~Limit() { setrlimit(resource_, &before_); }
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;

    rlim_t highest() const noexcept { return before_.rlim_max; }

private:
    __rlimit_resource resource_;
    rlimit before_{};
};

}  // namespace hertzline::test
