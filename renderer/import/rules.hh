/* What glTF 2.0 and the extensions that are read say about each JSON member: one table, checked before anything is believed. */
#pragma once

#include "import/json.hh"

namespace gltf
{

/* Fails with the path of the first member that breaks a rule. Whole numbers written as 3.0 become integers. */
void check_rules(json &root);

} // namespace gltf
