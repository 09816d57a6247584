// SPDX-License-Identifier: GPL-3.0-or-later
// node validate_glb.js FILE: exit code 0 when the Khronos validator finds no error and no warning.
const fs = require('fs');
const validator = require('gltf-validator');

validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2]))).then((report) => {
    const found = report.issues.messages.filter((m) => m.severity < 2);
    found.forEach((m) => console.log(m.code, m.pointer, m.message));
    process.exit(found.length === 0 && report.info.drawCallCount > 0 ? 0 : 1);
}, (error) => {
    console.log(String(error));
    process.exit(1);
});
