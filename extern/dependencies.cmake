# Every outside library, each as one interface target. All are Debian 12 packages; nothing is vendored or downloaded.
find_package(PkgConfig)
if(NOT PkgConfig_FOUND)
  message(FATAL_ERROR "pkg-config is missing. Install it with: apt-get install pkg-config")
endif()

# Stops with the name of the package to install.
function(granular_require found what package)
  if(NOT ${found})
    message(FATAL_ERROR "${what} is missing. Install it with: apt-get install ${package}")
  endif()
endfunction()

find_package(Eigen3 3.4 QUIET NO_MODULE)
granular_require(Eigen3_FOUND "Eigen 3.4" libeigen3-dev)

find_package(OpenMP QUIET COMPONENTS CXX)
granular_require(OpenMP_CXX_FOUND "OpenMP" "g++ (or libomp-14-dev for clang)")

# Bullet's own CMake package is the single-precision build: only pkg-config names the double one.
pkg_check_modules(BulletD QUIET IMPORTED_TARGET bullet-float64)
granular_require(BulletD_FOUND "Bullet in double precision (bullet-float64)" libbullet-dev)
add_library(granular_bullet INTERFACE)
target_link_libraries(granular_bullet INTERFACE PkgConfig::BulletD)

pkg_check_modules(Qhull QUIET IMPORTED_TARGET qhull_r)
granular_require(Qhull_FOUND "Qhull (reentrant)" libqhull-dev)
add_library(granular_qhull INTERFACE)
target_link_libraries(granular_qhull INTERFACE PkgConfig::Qhull)

find_package(assimp QUIET)
granular_require(assimp_FOUND "assimp" libassimp-dev)
add_library(granular_assimp INTERFACE)
target_link_libraries(granular_assimp INTERFACE assimp::assimp)

pkg_check_modules(Toml QUIET tomlplusplus)
granular_require(Toml_FOUND "toml++" libtomlplusplus-dev)
add_library(granular_toml INTERFACE)
target_compile_definitions(granular_toml INTERFACE TOML_HEADER_ONLY=1)

find_path(NLOHMANN_JSON_INCLUDE_DIR nlohmann/json.hpp)
granular_require(NLOHMANN_JSON_INCLUDE_DIR "nlohmann/json" nlohmann-json3-dev)
add_library(granular_json INTERFACE)

find_path(CLI11_INCLUDE_DIR CLI/CLI.hpp)
granular_require(CLI11_INCLUDE_DIR "CLI11" libcli11-dev)
add_library(granular_cli INTERFACE)

# By pkg-config, because CMake's own module asks every user of the installed library to enable C.
pkg_check_modules(Hdf5 QUIET IMPORTED_TARGET hdf5)
granular_require(Hdf5_FOUND "HDF5" libhdf5-dev)
add_library(granular_hdf5 INTERFACE)
target_link_libraries(granular_hdf5 INTERFACE PkgConfig::Hdf5)

find_package(fmt QUIET)
granular_require(fmt_FOUND "fmt" libfmt-dev)
add_library(granular_fmt INTERFACE)
target_link_libraries(granular_fmt INTERFACE fmt::fmt)

if(GRANULAR_TESTS)
  find_package(GTest QUIET)
  granular_require(GTest_FOUND "GoogleTest" libgtest-dev)
endif()

if(GRANULAR_BENCHMARKS)
  find_package(benchmark QUIET)
  granular_require(benchmark_FOUND "Google Benchmark" libbenchmark-dev)
endif()
