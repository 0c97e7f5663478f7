# Whether hertzline-mpi is built (apps/mpi): sweeps on all ranks of an MPI job. It is when OpenMPI is there: HERTZLINE_MPI=OFF leaves it
# out, ON insists on it. Not with the sanitizers: OpenMPI is not built with them, and its own leaks and races would be told of. What the
# ranks do is the libraries' work, which they watch.
set(hertzline_mpi_default OFF)
set(HERTZLINE_MPI_MISSING "hertzline-mpi is not built with the sanitizers")
if(NOT HERTZLINE_SANITIZE AND NOT HERTZLINE_FUZZ)
  set(MPI_CXX_SKIP_MPICXX ON)  # the C interface will do
  find_package(MPI 3 QUIET COMPONENTS CXX)
  if(NOT MPI_CXX_FOUND)
    set(HERTZLINE_MPI_MISSING "no MPI was found: libopenmpi-dev, openmpi-bin")
  else()
    set(HERTZLINE_MPI_MISSING "HERTZLINE_MPI is off")
    set(hertzline_mpi_default ON)
  endif()
endif()
option(HERTZLINE_MPI "Build hertzline-mpi" ${hertzline_mpi_default})
if(HERTZLINE_MPI AND NOT hertzline_mpi_default)
  message(FATAL_ERROR "HERTZLINE_MPI is on: ${HERTZLINE_MPI_MISSING}")
endif()
