# SPDX-License-Identifier: Apache-2.0
"""A wheel that needs nothing of this tree: the module with the shared library, which make compiles, beside it."""
import pathlib
import re
import shutil
import subprocess

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

ROOT = pathlib.Path(__file__).resolve().parents[2]
VERSION = re.search(r'define SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text(encoding="utf-8"))[1]
LIBRARY = f"libshade.so.{VERSION}"
SCRATCH = ROOT / "build/wheel"


class WithLibrary(build_py):
    def run(self):
        super().run()
        subprocess.run(["make", "-C", ROOT, "NEEDS=", f"build/{LIBRARY}"], check=True)
        package = pathlib.Path(self.build_lib, "shade")
        package.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "build" / LIBRARY, package)
        shutil.copy(ROOT / "LICENSES/Apache-2.0.txt", package)
        (package / "library.txt").write_text(LIBRARY + "\n", encoding="utf-8")  # as `make install` writes it


class Compiled(Distribution):
    """For one kind of machine, though nothing of it is Python's."""

    def has_ext_modules(self):
        return True


shutil.rmtree(SCRATCH, ignore_errors=True)  # what an older version had would go into the wheel
SCRATCH.mkdir(parents=True, exist_ok=True)
setup(name="libshade", version=VERSION, license="Apache-2.0", packages=["shade"], package_data={"shade": ["py.typed"]},
      description="Anisotropic shading whose microfacet distribution follows the perturbed normal",
      python_requires=">=3.10", install_requires=["numpy"], distclass=Compiled, cmdclass={"build_py": WithLibrary},
      options={"bdist_wheel": {"py_limited_api": "cp310"}, "egg_info": {"egg_base": str(SCRATCH)},
               "build": {"build_base": str(SCRATCH)}})
