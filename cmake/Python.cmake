# Decides whether `import hertzline` is built (apps/python), and for which Python. By default (AUTO) it is built where pybind11 is
# found; HERTZLINE_PYTHON=OFF leaves it out, ON requires it. It is not built with the sanitizers: their run-time library would have to be
# loaded before the interpreter, and the interpreter's own leaks would be reported. The sanitizers check the libraries that the module
# calls.
set(hertzline_python_possible OFF)
set(HERTZLINE_PYTHON_MISSING "the Python module is not built with the sanitizers")
if(NOT HERTZLINE_SANITIZE AND NOT HERTZLINE_FUZZ)
  set(PYBIND11_FINDPYTHON ON)
  if(NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The Python that the module is for")
  endif()
  find_package(Python 3.11 QUIET COMPONENTS Interpreter Development.Module NumPy)
  find_package(pybind11 2.10 QUIET CONFIG)
  if(NOT Python_FOUND)
    set(HERTZLINE_PYTHON_MISSING "no Python from 3.11 on with its headers and numpy was found: python3-dev, python3-numpy")
  elseif(NOT pybind11_FOUND)
    set(HERTZLINE_PYTHON_MISSING "pybind11 was not found: pybind11-dev")
  else()
    set(HERTZLINE_PYTHON_MISSING "HERTZLINE_PYTHON is off")
    set(hertzline_python_possible ON)
    set(HERTZLINE_PYBIND11 ${pybind11_VERSION} CACHE INTERNAL "The pybind11 that makes the module; setup.py reads it")
  endif()
endif()
set(HERTZLINE_PYTHON AUTO CACHE STRING "Build the Python module: ON, OFF, AUTO")
if(HERTZLINE_PYTHON STREQUAL AUTO)
  set(HERTZLINE_PYTHON ${hertzline_python_possible})  # for this configuration: packages may be installed before the next
elseif(HERTZLINE_PYTHON AND NOT hertzline_python_possible)
  message(FATAL_ERROR "HERTZLINE_PYTHON is on: ${HERTZLINE_PYTHON_MISSING}")
endif()
