"""Compiled programs are kept in the user's cache folder, so that a command compiles a kind of lens only once."""

from __future__ import annotations

import os

import jax
import platformdirs


def keep_compiled_programs() -> None:
    """Switch on JAX's persistent compilation cache, unless the environment says where it is, or that there is none."""
    if os.environ.get("JAX_ENABLE_COMPILATION_CACHE") == "false":
        return
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
        folder = os.path.join(platformdirs.user_cache_dir("lenstrace"), "compiled")
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError:  # a home that cannot be written does without
            return
        jax.config.update("jax_compilation_cache_dir", folder)
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
