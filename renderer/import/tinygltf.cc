/* tinygltf's body, built here because the packaged library has the image readers and the file access that tinygltf.hh leaves out. */
#include <fstream>

#define TINYGLTF_IMPLEMENTATION
#include "import/tinygltf.hh"
