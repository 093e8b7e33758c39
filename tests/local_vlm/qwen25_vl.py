"""Qwen2.5-VL of any size with random weights, as a folder that transformers loads."""

from pathlib import Path
from typing import Any

_CHAT = (
    "{% for m in messages %}<|im_start|>{{ m['role'] }}\n"
    "{% if m['content'] is string %}{{ m['content'] }}{% else %}{% for c in m['content'] %}"
    "{% if c['type'] == 'image' %}<|vision_start|><|image_pad|><|vision_end|>"
    "{% elif 'text' in c %}{{ c['text'] }}{% endif %}{% endfor %}{% endif %}<|im_end|>\n"
    "{% endfor %}{% if add_generation_prompt %}<|im_start|>assistant\n{% endif %}"
)
_SPECIAL = {
    "eos_token": "<|im_end|>",
    "pad_token": "<|endoftext|>",
    "additional_special_tokens": [
        "<|im_start|>",
        "<|vision_start|>",
        "<|vision_end|>",
        "<|image_pad|>",
        "<|video_pad|>",
    ],
}


def save_qwen25_vl(
    folder: Path,
    alphabet: Any,
    text: dict[str, Any],
    vision: dict[str, Any],
    *,
    ends: bool = True,
    device: Any = "cpu",
    dtype: Any = None,
) -> Path:
    """Write model and processor.

    Args:
        folder: Where they go.
        alphabet: Tokenizer of plain text, of the tokenizers library.
        text: Sizes of the language model; as many words as the tokenizer has unless they say so.
        vision: Sizes of the vision encoder.
        ends: Whether an answer ends by itself; else it has as many tokens as are allowed.
        device: Where the weights are drawn.
        dtype: Format of the weights; torch's usual one by default.
    """
    import torch
    import transformers as hf

    tokenizer = hf.PreTrainedTokenizerFast(tokenizer_object=alphabet, **_SPECIAL)
    ids = tokenizer.convert_tokens_to_ids
    config = hf.Qwen2_5_VLConfig(
        text_config={
            "vocab_size": len(tokenizer),
            "eos_token_id": ids("<|im_end|>"),
            "pad_token_id": ids("<|endoftext|>"),
            **text,
        },
        vision_config={"out_hidden_size": text["hidden_size"], **vision},
        image_token_id=ids("<|image_pad|>"),
        video_token_id=ids("<|video_pad|>"),
        vision_start_token_id=ids("<|vision_start|>"),
        vision_end_token_id=ids("<|vision_end|>"),
        tie_word_embeddings=text.get("tie_word_embeddings", False),
    )
    torch.manual_seed(0)
    usual = torch.get_default_dtype()
    torch.set_default_dtype(dtype or usual)
    try:
        with torch.device(device):
            model = hf.Qwen2_5_VLForConditionalGeneration(config)
    finally:
        torch.set_default_dtype(usual)
    model.generation_config.eos_token_id = ids("<|im_end|>") if ends else None
    model.generation_config.pad_token_id = ids("<|endoftext|>")
    processor = hf.Qwen2_5_VLProcessor(
        image_processor=hf.Qwen2VLImageProcessor(min_pixels=56 * 56, max_pixels=28 * 28 * 1280),
        tokenizer=tokenizer,
        video_processor=hf.Qwen2VLVideoProcessor(),
        chat_template=_CHAT,
    )
    model.save_pretrained(folder)
    processor.save_pretrained(folder)
    return folder
