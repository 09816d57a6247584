// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/avatar.h"
#include "sewing/garment.h"

#include <string>

namespace toile {

/// The points of a mesh in frame after frame at equal times, at least one frame, all of as many points.
struct PointFrames {
    const std::vector<Points>& frames;
    double rate; ///< per second, positive
};

/// Of a written OBJ; GLB is metres and y up by its standard.
struct WriteOptions {
    double metres_per_unit = 1;      ///< 1 m, 0.01 cm, 0.001 mm
    bool z_up = false;               ///< otherwise y up; z up is (x, -z, y)
    const TriMesh* avatar = nullptr; ///< written too, as an object or mesh of its own called "avatar"
    const PointFrames* motion = nullptr; ///< GLB: played as an animation; the last of its frames is the garment
};

/// A point in metres, y up, as a file of these options has it.
inline Vec3 in_obj(const Vec3& p, const WriteOptions& options) {
    return (options.z_up ? Vec3(p.x(), -p.z(), p.y()) : p) / options.metres_per_unit;
}

struct ReadGarment;

enum class GarmentFormat { obj, glb };

/// By the file's ending, whatever its case. Throws InputError that lists the endings when it is none of them.
GarmentFormat garment_format(const std::string& path);

/// By the file's ending: .obj (with .mtl beside it) or .glb. Written beside the target and renamed.
/// OBJ carries every double exactly (in metres), GLB the nearest floats.
/// Throws InputError when the target cannot be written.
void write_garment(const std::string& path, const Garment& garment, const Points& x,
                   const WriteOptions& options = {});

/// Writes a garment that was read from the file `from` with its nodes at x. In the format of `from` everything else of it
/// stays as it is: faces, texture coordinates, groups, materials, unit and up axis, the order of all; files that it names
/// are not copied. In the other format it is a garment of toile's, as write_garment() makes it. Throws InputError.
void write_moved(const std::string& path, const std::string& from, const ReadGarment& read, const Points& x);

/// Every file that write_moved(path, from) makes.
std::vector<std::string> moved_files(const std::string& path, const std::string& from);

/// Bytes of a GLB's animation, near enough.
double animation_bytes(const Garment& garment, int frames);

/// Every file that write_garment(path) makes.
std::vector<std::string> garment_files(const std::string& path);

/// A mesh as a plain OBJ.
void write_mesh(const std::string& path, const TriMesh& mesh, const WriteOptions& options = {});

/// The positions that a GLB carries: rounded to float.
Points rounded_to_float(const Points& x);

} // namespace toile
