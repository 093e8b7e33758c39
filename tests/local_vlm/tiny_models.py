"""The real architectures in a size that fits a test: random weights, real processors.

What they say is nonsense, but it is nonsense of the real shape.
"""

from pathlib import Path
from typing import Any

from qwen25_vl import save_qwen25_vl

_SMALL = {"hidden_size": 32, "num_hidden_layers": 2, "num_attention_heads": 4}


def _bytes() -> Any:
    """A token a byte."""
    from tokenizers import Tokenizer, decoders, models, pre_tokenizers

    alphabet = sorted(pre_tokenizers.ByteLevel.alphabet())
    vocabulary = {character: number for number, character in enumerate(alphabet)}
    tokenizer = Tokenizer(models.BPE(vocab=vocabulary, merges=[]))
    tokenizer.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    tokenizer.decoder = decoders.ByteLevel()
    return tokenizer


def _short_tokenizer() -> Any:
    """A token a byte, with beginning and end around a text, as CLIP needs them."""
    from tokenizers import processors
    from transformers import PreTrainedTokenizerFast

    tokenizer = _bytes()
    tokenizer.add_special_tokens(["<pad>", "<s>", "</s>"])
    tokenizer.post_processor = processors.TemplateProcessing(
        single="<s> $A </s>", special_tokens=[("<s>", 257), ("</s>", 258)]
    )
    return PreTrainedTokenizerFast(
        tokenizer_object=tokenizer,
        pad_token="<pad>",
        bos_token="<s>",
        eos_token="</s>",
        model_max_length=64,
    )


def _saved(folder: Path, model: Any, processor: Any) -> Path:
    model.save_pretrained(folder)
    processor.save_pretrained(folder)
    return folder


def qwen25_vl(folder: Path) -> Path:
    """Qwen2.5-VL: 2 layers, 115,000 weights."""
    text = {
        **_SMALL,
        "intermediate_size": 64,
        "num_key_value_heads": 2,
        "max_position_embeddings": 8192,
        "rope_parameters": {
            "rope_type": "default",
            "mrope_section": [1, 1, 2],
            "rope_theta": 1e6,
        },
    }
    vision = {
        "depth": 2,
        "num_heads": 4,
        "hidden_size": 32,
        "intermediate_size": 64,
        "fullatt_block_indexes": [1],
    }
    return save_qwen25_vl(folder, _bytes(), text, vision)


def _prompt_and_decoder() -> dict[str, Any]:
    return {
        "prompt_encoder_config": {
            "hidden_size": 32,
            "image_size": 64,
            "patch_size": 16,
            "mask_input_channels": 4,
        },
        "mask_decoder_config": {
            **_SMALL,
            "mlp_dim": 64,
            "iou_head_hidden_dim": 32,
        },
    }


def sam(folder: Path) -> Path:
    """SAM with an image of 64×64."""
    import torch
    import transformers as hf

    torch.manual_seed(0)
    vision = {
        **_SMALL,
        "output_channels": 32,
        "image_size": 64,
        "patch_size": 16,
        "window_size": 2,
        "global_attn_indexes": [1],
        "mlp_dim": 64,
        "num_pos_feats": 16,
    }
    model = hf.SamModel(hf.SamConfig(vision_config=vision, **_prompt_and_decoder()))
    images = hf.SamImageProcessor(
        size={"longest_edge": 64},
        pad_size={"height": 64, "width": 64},
        mask_size={"longest_edge": 16},
        mask_pad_size={"height": 16, "width": 16},
    )
    return _saved(folder, model, hf.SamProcessor(image_processor=images))


def sam2(folder: Path) -> Path:
    """SAM 2 with an image of 64×64."""
    import torch
    import transformers as hf

    torch.manual_seed(0)
    backbone = hf.Sam2HieraDetConfig(
        hidden_size=16,
        num_attention_heads=1,
        image_size=[64, 64],
        blocks_per_stage=[1, 1, 2, 1],
        embed_dim_per_stage=[16, 32, 64, 128],
        num_attention_heads_per_stage=[1, 2, 4, 8],
        window_size_per_stage=[8, 4, 4, 4],
        global_attention_blocks=[3],
        window_positional_embedding_background_size=[4, 4],
    )
    vision = {
        "backbone_config": backbone.to_dict(),
        "backbone_channel_list": [128, 64, 32, 16],
        "fpn_hidden_size": 32,
        "backbone_feature_sizes": [[16, 16], [8, 8], [4, 4]],
    }
    model = hf.Sam2Model(hf.Sam2Config(vision_config=vision, **_prompt_and_decoder()))
    images = hf.Sam2ImageProcessor(
        size={"height": 64, "width": 64}, mask_size={"height": 16, "width": 16}
    )
    return _saved(folder, model, hf.Sam2Processor(image_processor=images))


def _text_config() -> dict[str, Any]:
    return {
        **_SMALL,
        "vocab_size": 300,
        "intermediate_size": 64,
        "max_position_embeddings": 64,
        "bos_token_id": 257,
        "eos_token_id": 258,
        "pad_token_id": 256,
    }


def owlv2(folder: Path) -> Path:
    """OWLv2 with an image of 64×64: 16 boxes."""
    import torch
    import transformers as hf

    torch.manual_seed(0)
    config = hf.Owlv2Config(
        text_config=_text_config(),
        vision_config={**_SMALL, "intermediate_size": 64, "image_size": 64, "patch_size": 16},
        projection_dim=32,
    )
    processor = hf.Owlv2Processor(
        image_processor=hf.Owlv2ImageProcessor(size={"height": 64, "width": 64}),
        tokenizer=_short_tokenizer(),
    )
    return _saved(folder, hf.Owlv2ForObjectDetection(config), processor)


def grounding_dino(folder: Path) -> Path:
    """Grounding DINO with a Swin and a BERT of a few layers."""
    import torch
    import transformers as hf
    from tokenizers import Tokenizer, models, pre_tokenizers, processors

    torch.manual_seed(0)
    words = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]", ".", "?", "a", "bed", "red", "sofa"]
    vocabulary = {word: number for number, word in enumerate(words)}
    tokenizer = Tokenizer(models.WordPiece(vocabulary, unk_token="[UNK]"))
    tokenizer.pre_tokenizer = pre_tokenizers.BertPreTokenizer()
    tokenizer.post_processor = processors.TemplateProcessing(
        single="[CLS] $A [SEP]", special_tokens=[("[CLS]", 2), ("[SEP]", 3)]
    )
    text = hf.PreTrainedTokenizerFast(
        tokenizer_object=tokenizer,
        pad_token="[PAD]",
        unk_token="[UNK]",
        cls_token="[CLS]",
        sep_token="[SEP]",
        mask_token="[MASK]",
        model_max_length=64,
    )
    config = hf.GroundingDinoConfig(
        backbone_config=hf.SwinConfig(
            image_size=64,
            patch_size=4,
            embed_dim=16,
            depths=[1, 1, 1, 1],
            num_heads=[1, 2, 4, 8],
            window_size=2,
            out_features=["stage2", "stage3", "stage4"],
        ),
        text_config=hf.BertConfig(
            vocab_size=len(words), intermediate_size=64, max_position_embeddings=64, **_SMALL
        ),
        num_queries=20,
        encoder_layers=1,
        encoder_ffn_dim=64,
        encoder_attention_heads=4,
        decoder_layers=2,
        decoder_ffn_dim=64,
        decoder_attention_heads=4,
        d_model=32,
        max_text_len=64,
    )
    processor = hf.GroundingDinoProcessor(
        image_processor=hf.GroundingDinoImageProcessor(
            size={"shortest_edge": 64, "longest_edge": 96}
        ),
        tokenizer=text,
    )
    return _saved(folder, hf.GroundingDinoForObjectDetection(config), processor)


def clip(folder: Path) -> Path:
    """CLIP with an image of 32×32."""
    import torch
    import transformers as hf

    torch.manual_seed(0)
    config = hf.CLIPConfig(
        text_config=_text_config(),
        vision_config={**_SMALL, "intermediate_size": 64, "image_size": 32, "patch_size": 16},
        projection_dim=32,
    )
    processor = hf.CLIPProcessor(
        image_processor=hf.CLIPImageProcessor(
            size={"shortest_edge": 32}, crop_size={"height": 32, "width": 32}
        ),
        tokenizer=_short_tokenizer(),
    )
    return _saved(folder, hf.CLIPModel(config), processor)


def siglip(folder: Path) -> Path:
    """SigLIP with an image of 32×32."""
    import torch
    import transformers as hf

    torch.manual_seed(0)
    config = hf.SiglipConfig(
        text_config={**_text_config(), "projection_size": 32},
        vision_config={**_SMALL, "intermediate_size": 64, "image_size": 32, "patch_size": 16},
    )
    processor = hf.SiglipProcessor(
        image_processor=hf.SiglipImageProcessor(size={"height": 32, "width": 32}),
        tokenizer=_short_tokenizer(),
    )
    return _saved(folder, hf.SiglipModel(config), processor)


def blip2(folder: Path) -> Path:
    """BLIP-2 with its matching head and an image of 32×32."""
    import torch
    import transformers as hf

    torch.manual_seed(0)
    tokenizer = _short_tokenizer()
    tokenizer.add_special_tokens({"additional_special_tokens": ["<image>"]})
    config = hf.Blip2Config(
        vision_config={
            **_SMALL,
            "intermediate_size": 64,
            "image_size": 32,
            "patch_size": 16,
            "initializer_range": 0.02,  # its own 1e-10 makes all images equal
        },
        qformer_config={
            **_SMALL,
            "vocab_size": 300,
            "intermediate_size": 64,
            "encoder_hidden_size": 32,
            "use_qformer_text_input": True,
            "max_position_embeddings": 64,
        },
        text_config={
            "model_type": "opt",
            **_SMALL,
            "vocab_size": 300,
            "ffn_dim": 64,
            "word_embed_proj_dim": 32,
        },
        num_query_tokens=4,
        image_text_hidden_size=16,
        image_token_index=tokenizer.convert_tokens_to_ids("<image>"),
    )
    processor = hf.Blip2Processor(
        image_processor=hf.BlipImageProcessor(size={"height": 32, "width": 32}),
        tokenizer=tokenizer,
        num_query_tokens=4,
    )
    return _saved(folder, hf.Blip2ForImageTextRetrieval(config), processor)
