// The libraries that most subcommands do without: linked, they and the libraries that they bring along would take most of the time of
// each start. Their functions are defined here, so that the linker leaves the libraries out. The first call of a function loads its
// library. The modules know nothing of it; other programs link the libraries.

#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <tuple>

#include <fftw3.h>
#include <nlopt.h>
#include <sodium.h>
#include <sqlite3.h>
#include <zmq.h>

#include "recordings/files/shared_library.hpp"

namespace {

using hertzline::recordings::SharedLibrary;

/// The types of a function. signature_of() deduces them, as a template argument would lose the attributes of a library's function.
template <class R, class... Parameters>
struct Signature {
    using Result = R;
    template <std::size_t i>
    using Parameter = std::tuple_element_t<i, std::tuple<Parameters...>>;
};
template <class R, class... Parameters>
Signature<R, Parameters...> signature_of(R (*)(Parameters...));

/// Returns the library's function of that name and type. @throws std::runtime_error when the library is not there or has none
template <class Function>
Function* late(Function* /*here*/, const SharedLibrary& library, const char* name) {
    const int error = errno;  // which zmq_errno() returns
    Function* function = nullptr;
    library.find(function, name);
    errno = error;
    return function;
}

// NOLINTBEGIN(cppcoreguidelines-macro-usage,bugprone-macro-parentheses)
#define HERTZLINE_LIBRARY(library, name)         \
    const SharedLibrary& library() {             \
        static const SharedLibrary loaded(name); \
        return loaded;                           \
    }
HERTZLINE_LIBRARY(fftw, HERTZLINE_FFTW_LIBRARY)
HERTZLINE_LIBRARY(nlopt, HERTZLINE_NLOPT_LIBRARY)
HERTZLINE_LIBRARY(sodium, HERTZLINE_SODIUM_LIBRARY)
HERTZLINE_LIBRARY(sqlite, HERTZLINE_SQLITE_LIBRARY)
HERTZLINE_LIBRARY(zmq, HERTZLINE_ZMQ_LIBRARY)

}  // namespace

#define HERTZLINE_PARAMETER(name, i) decltype(signature_of(&name))::Parameter<i>
#define HERTZLINE_PARAMETERS_0(name)
#define HERTZLINE_PARAMETERS_1(name) HERTZLINE_PARAMETER(name, 0) a
#define HERTZLINE_PARAMETERS_2(name) HERTZLINE_PARAMETERS_1(name), HERTZLINE_PARAMETER(name, 1) b
#define HERTZLINE_PARAMETERS_3(name) HERTZLINE_PARAMETERS_2(name), HERTZLINE_PARAMETER(name, 2) c
#define HERTZLINE_PARAMETERS_4(name) HERTZLINE_PARAMETERS_3(name), HERTZLINE_PARAMETER(name, 3) d
#define HERTZLINE_PARAMETERS_5(name) HERTZLINE_PARAMETERS_4(name), HERTZLINE_PARAMETER(name, 4) e
#define HERTZLINE_PARAMETERS_6(name) HERTZLINE_PARAMETERS_5(name), HERTZLINE_PARAMETER(name, 5) f
#define HERTZLINE_ARGUMENTS_0
#define HERTZLINE_ARGUMENTS_1 a
#define HERTZLINE_ARGUMENTS_2 a, b
#define HERTZLINE_ARGUMENTS_3 a, b, c
#define HERTZLINE_ARGUMENTS_4 a, b, c, d
#define HERTZLINE_ARGUMENTS_5 a, b, c, d, e
#define HERTZLINE_ARGUMENTS_6 a, b, c, d, e, f
/// Defines a function of a library. @param count of its parameters
#define HERTZLINE_LATE(library, name, count)                                         \
    decltype(signature_of(&name))::Result name(HERTZLINE_PARAMETERS_##count(name)) { \
        static auto* const function = late(&name, library(), #name);                 \
        return function(HERTZLINE_ARGUMENTS_##count);                                \
    }

HERTZLINE_LATE(fftw, fftw_destroy_plan, 1)
HERTZLINE_LATE(fftw, fftw_execute, 1)
HERTZLINE_LATE(fftw, fftw_plan_dft_1d, 5)

HERTZLINE_LATE(nlopt, nlopt_create, 2)
HERTZLINE_LATE(nlopt, nlopt_destroy, 1)
HERTZLINE_LATE(nlopt, nlopt_get_dimension, 1)
HERTZLINE_LATE(nlopt, nlopt_get_errmsg, 1)
HERTZLINE_LATE(nlopt, nlopt_optimize, 3)
HERTZLINE_LATE(nlopt, nlopt_set_force_stop, 2)
HERTZLINE_LATE(nlopt, nlopt_set_initial_step1, 2)
HERTZLINE_LATE(nlopt, nlopt_set_lower_bounds1, 2)
HERTZLINE_LATE(nlopt, nlopt_set_maxeval, 2)
HERTZLINE_LATE(nlopt, nlopt_set_min_objective, 3)
HERTZLINE_LATE(nlopt, nlopt_set_munge, 3)
HERTZLINE_LATE(nlopt, nlopt_set_upper_bounds1, 2)
HERTZLINE_LATE(nlopt, nlopt_set_xtol_abs1, 2)
HERTZLINE_LATE(nlopt, nlopt_version, 3)

HERTZLINE_LATE(sodium, crypto_hash_sha512, 3)
HERTZLINE_LATE(sodium, crypto_hash_sha512_final, 2)
HERTZLINE_LATE(sodium, crypto_hash_sha512_init, 1)
HERTZLINE_LATE(sodium, crypto_hash_sha512_update, 3)
HERTZLINE_LATE(sodium, sodium_bin2hex, 4)

HERTZLINE_LATE(sqlite, sqlite3_bind_blob64, 5)
HERTZLINE_LATE(sqlite, sqlite3_bind_double, 3)
HERTZLINE_LATE(sqlite, sqlite3_bind_int64, 3)
HERTZLINE_LATE(sqlite, sqlite3_bind_text64, 6)
HERTZLINE_LATE(sqlite, sqlite3_busy_timeout, 2)
HERTZLINE_LATE(sqlite, sqlite3_close_v2, 1)
HERTZLINE_LATE(sqlite, sqlite3_column_blob, 2)
HERTZLINE_LATE(sqlite, sqlite3_column_bytes, 2)
HERTZLINE_LATE(sqlite, sqlite3_column_double, 2)
HERTZLINE_LATE(sqlite, sqlite3_column_int64, 2)
HERTZLINE_LATE(sqlite, sqlite3_column_text, 2)
HERTZLINE_LATE(sqlite, sqlite3_column_type, 2)
HERTZLINE_LATE(sqlite, sqlite3_errmsg, 1)
HERTZLINE_LATE(sqlite, sqlite3_errstr, 1)
HERTZLINE_LATE(sqlite, sqlite3_exec, 5)
HERTZLINE_LATE(sqlite, sqlite3_extended_result_codes, 2)
HERTZLINE_LATE(sqlite, sqlite3_file_control, 4)
HERTZLINE_LATE(sqlite, sqlite3_finalize, 1)
HERTZLINE_LATE(sqlite, sqlite3_get_autocommit, 1)
HERTZLINE_LATE(sqlite, sqlite3_open, 2)
HERTZLINE_LATE(sqlite, sqlite3_open_v2, 4)
HERTZLINE_LATE(sqlite, sqlite3_prepare_v2, 5)
HERTZLINE_LATE(sqlite, sqlite3_reset, 1)
HERTZLINE_LATE(sqlite, sqlite3_step, 1)
HERTZLINE_LATE(sqlite, sqlite3_system_errno, 1)

HERTZLINE_LATE(zmq, zmq_bind, 2)
HERTZLINE_LATE(zmq, zmq_close, 1)
HERTZLINE_LATE(zmq, zmq_connect, 2)
HERTZLINE_LATE(zmq, zmq_ctx_new, 0)
HERTZLINE_LATE(zmq, zmq_ctx_term, 1)
HERTZLINE_LATE(zmq, zmq_curve_keypair, 2)
HERTZLINE_LATE(zmq, zmq_curve_public, 2)
HERTZLINE_LATE(zmq, zmq_errno, 0)
HERTZLINE_LATE(zmq, zmq_getsockopt, 4)
HERTZLINE_LATE(zmq, zmq_has, 1)
HERTZLINE_LATE(zmq, zmq_msg_close, 1)
HERTZLINE_LATE(zmq, zmq_msg_copy, 2)
HERTZLINE_LATE(zmq, zmq_msg_data, 1)
HERTZLINE_LATE(zmq, zmq_msg_get, 2)
HERTZLINE_LATE(zmq, zmq_msg_gets, 2)
HERTZLINE_LATE(zmq, zmq_msg_init, 1)
HERTZLINE_LATE(zmq, zmq_msg_init_data, 5)
HERTZLINE_LATE(zmq, zmq_msg_more, 1)
HERTZLINE_LATE(zmq, zmq_msg_recv, 3)
HERTZLINE_LATE(zmq, zmq_msg_send, 3)
HERTZLINE_LATE(zmq, zmq_msg_size, 1)
HERTZLINE_LATE(zmq, zmq_poll, 3)
HERTZLINE_LATE(zmq, zmq_send, 4)
HERTZLINE_LATE(zmq, zmq_setsockopt, 4)
HERTZLINE_LATE(zmq, zmq_socket, 2)
HERTZLINE_LATE(zmq, zmq_socket_monitor, 3)
HERTZLINE_LATE(zmq, zmq_strerror, 1)
HERTZLINE_LATE(zmq, zmq_z85_decode, 2)
HERTZLINE_LATE(zmq, zmq_z85_encode, 3)
// NOLINTEND(cppcoreguidelines-macro-usage,bugprone-macro-parentheses)

/// With the options that have a number and the address of one.
int sqlite3_db_config(sqlite3* database, int option, ...) {
    static auto* const function = late(&sqlite3_db_config, sqlite(), "sqlite3_db_config");
    std::va_list values;
    va_start(values, option);
    const int wanted = va_arg(values, int);
    int* const found = va_arg(values, int*);
    va_end(values);
    return function(database, option, wanted, found);
}
