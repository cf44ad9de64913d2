# cmake --install: the library, its public headers, and a package that find_package(granular) reads.
include(CMakePackageConfigHelpers)

# A static library hands its own dependencies on to the linker of whoever uses it: they are exported along with it.
set(packageDir ${CMAKE_INSTALL_LIBDIR}/cmake/granular)
set(dependencies bullet qhull assimp toml json hdf5 fmt)
foreach(dependency ${dependencies})
  set_target_properties(granular_${dependency} PROPERTIES EXPORT_NAME ${dependency})
  install(TARGETS granular_${dependency} EXPORT granularTargets)
endforeach()
install(TARGETS granular EXPORT granularTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT granularTargets NAMESPACE granular:: DESTINATION ${packageDir})

# Headers named bullet_* need Bullet's own headers and stay inside.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/granular/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/granular
  FILES_MATCHING PATTERN "*.h" PATTERN "bullet_*.h" EXCLUDE)

configure_package_config_file(extern/granularConfig.cmake.in ${PROJECT_BINARY_DIR}/granularConfig.cmake
  INSTALL_DESTINATION ${packageDir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/granularConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/granularConfig.cmake ${PROJECT_BINARY_DIR}/granularConfigVersion.cmake
  DESTINATION ${packageDir})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
