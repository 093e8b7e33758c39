"""A Qwen2.5-VL of random weights as two GGUF files, 1.4 MB, for llama.cpp's server.

Names of tensors and keys are those that llama.cpp's ``clip.cpp`` and the package ``gguf`` have.
"""

from pathlib import Path

import numpy as np
from gguf import GGUFWriter, TokenType

NAME = "Qwen2.5-VL-random"
_WIDTH, _FEED, _HEADS, _KEY_HEADS, _LAYERS, _PATCH, _CONTEXT = 64, 128, 4, 2, 2, 14, 8192
_HEAD = _WIDTH // _HEADS
_SPECIAL = (
    *("<|endoftext|>", "<|im_start|>", "<|im_end|>"),
    *("<|vision_start|>", "<|vision_end|>", "<|image_pad|>"),
)
_CHAT = (
    "{% for m in messages %}<|im_start|>{{ m['role'] }}\n{{ m['content'] }}<|im_end|>\n{% endfor %}"
    "{% if add_generation_prompt %}<|im_start|>assistant\n{% endif %}"
)


def write_model(folder: Path) -> tuple[Path, Path]:
    """Write the language model and the vision encoder; the same bytes every time."""
    rng = np.random.default_rng(0)
    text, vision = folder / f"{NAME}.gguf", folder / f"mmproj-{NAME}.gguf"
    _write(GGUFWriter(text, "qwen2vl"), _add_text, rng)
    _write(GGUFWriter(vision, "clip"), _add_vision, rng)
    return text, vision


def _write(writer: GGUFWriter, add, rng: np.random.Generator) -> None:
    add(writer, rng)
    writer.write_header_to_file()
    writer.write_kv_data_to_file()
    writer.write_tensors_to_file()
    writer.close()


def _add_text(writer: GGUFWriter, rng: np.random.Generator) -> None:
    tokens = [*_byte_alphabet(), *_SPECIAL]
    writer.add_name(NAME)
    writer.add_context_length(_CONTEXT)
    writer.add_embedding_length(_WIDTH)
    writer.add_block_count(_LAYERS)
    writer.add_feed_forward_length(_FEED)
    writer.add_head_count(_HEADS)
    writer.add_head_count_kv(_KEY_HEADS)
    writer.add_rope_freq_base(1e6)
    writer.add_layer_norm_rms_eps(1e-6)
    writer.add_rope_dimension_sections([2, 3, 3, 0])
    writer.add_tokenizer_model("gpt2")
    writer.add_tokenizer_pre("qwen2")
    writer.add_token_list(tokens)
    writer.add_token_types([TokenType.NORMAL] * 256 + [TokenType.CONTROL] * len(_SPECIAL))
    writer.add_token_merges(["\u0120 t"])  # never used, since the vocabulary has no such token
    writer.add_eos_token_id(tokens.index("<|im_end|>"))
    writer.add_pad_token_id(tokens.index("<|endoftext|>"))
    writer.add_add_bos_token(False)
    writer.add_chat_template(_CHAT)
    for name in ("token_embd", "output"):
        writer.add_tensor(f"{name}.weight", 8.0 * _drawn(rng, len(tokens), _WIDTH))
    writer.add_tensor("output_norm.weight", _ones(_WIDTH))
    for number in range(_LAYERS):
        block = f"blk.{number}"
        for part, heads in (("q", _HEADS), ("k", _KEY_HEADS), ("v", _KEY_HEADS)):
            _add_layer(writer, rng, f"{block}.attn_{part}", heads * _HEAD, _WIDTH)
        for name, shape in (
            ("attn_output", (_WIDTH, _WIDTH)),
            ("ffn_gate", (_FEED, _WIDTH)),
            ("ffn_up", (_FEED, _WIDTH)),
            ("ffn_down", (_WIDTH, _FEED)),
        ):
            writer.add_tensor(f"{block}.{name}.weight", _drawn(rng, *shape))
        for name in ("attn_norm", "ffn_norm"):
            writer.add_tensor(f"{block}.{name}.weight", _ones(_WIDTH))


def _add_vision(writer: GGUFWriter, rng: np.random.Generator) -> None:
    writer.add_type("mmproj")
    writer.add_clip_has_vision_encoder(True)
    writer.add_clip_projector_type("qwen2.5vl_merger")
    writer.add_vision_image_size(560)
    writer.add_vision_patch_size(_PATCH)
    writer.add_vision_embedding_length(_WIDTH)
    writer.add_vision_feed_forward_length(_FEED)
    writer.add_vision_projection_dim(_WIDTH)
    writer.add_vision_block_count(_LAYERS)
    writer.add_vision_head_count(_HEADS)
    writer.add_vision_attention_layernorm_eps(1e-6)
    writer.add_vision_image_mean([0.48145466, 0.4578275, 0.40821073])
    writer.add_vision_image_std([0.26862954, 0.26130258, 0.27577711])
    writer.add_vision_use_silu(True)
    writer.add_vision_n_wa_pattern(2)
    for suffix in ("", ".1"):  # of two frames
        weight = _drawn(rng, _WIDTH, 3, _PATCH, _PATCH)
        writer.add_tensor(f"v.patch_embd.weight{suffix}", weight)
    writer.add_tensor("v.post_ln.weight", _ones(_WIDTH))
    for number in range(_LAYERS):
        block = f"v.blk.{number}"
        for name in ("ln1", "ln2"):
            writer.add_tensor(f"{block}.{name}.weight", _ones(_WIDTH))
        for name in ("attn_q", "attn_k", "attn_v", "attn_out"):
            _add_layer(writer, rng, f"{block}.{name}", _WIDTH, _WIDTH)
        for name in ("ffn_gate", "ffn_up"):
            _add_layer(writer, rng, f"{block}.{name}", _FEED, _WIDTH)
        _add_layer(writer, rng, f"{block}.ffn_down", _WIDTH, _FEED)
    _add_layer(writer, rng, "mm.0", 4 * _WIDTH, 4 * _WIDTH)  # four patches are one token
    _add_layer(writer, rng, "mm.2", _WIDTH, 4 * _WIDTH)


def _add_layer(
    writer: GGUFWriter, rng: np.random.Generator, name: str, rows: int, columns: int
) -> None:
    writer.add_tensor(f"{name}.weight", _drawn(rng, rows, columns))
    writer.add_tensor(f"{name}.bias", np.zeros(rows, np.float32))


def _drawn(rng: np.random.Generator, *shape: int) -> np.ndarray:
    return rng.normal(0.0, 0.5 / np.sqrt(shape[-1]), shape).astype(np.float32)


def _ones(count: int) -> np.ndarray:
    return np.ones(count, np.float32)


def _byte_alphabet() -> list[str]:
    """The characters that stand for the 256 bytes in a vocabulary of GPT-2's kind."""
    plain = [*range(33, 127), *range(161, 173), *range(174, 256)]
    others = [one for one in range(256) if one not in plain]
    codes = {one: one for one in plain} | {one: 256 + n for n, one in enumerate(others)}
    return [chr(codes[one]) for one in range(256)]
