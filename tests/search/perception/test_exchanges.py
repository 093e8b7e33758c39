from hypernav.core.embodiment import Action
from hypernav.core.trace import DetectionRecord, Exchange, Mode, StepTrace
from hypernav.search.perception.exchanges import unusable_answers

BOX = DetectionRecord(box=(0.0, 0.0, 9.0, 9.0), score=1.0, label="bed")


def step(*exchanges: Exchange, detections: list[DetectionRecord] | None = None) -> StepTrace:
    return StepTrace(
        step=0,
        pose=(0.0, 0.0, 0.0),
        action=Action.TURN_LEFT,
        mode=Mode.EXPLORE,
        exchanges=list(exchanges),
        detections=detections or [],
    )


def exchange(kind: str, fault: str = "", *remarks: str, by_model: bool = True) -> Exchange:
    return Exchange(
        kind=kind,
        asked="m",
        by_model=by_model,
        question="",
        answer="",
        fault=fault,
        remarks=[*remarks],
    )


def test_faults_count_by_reason():
    found = unusable_answers(
        step(exchange("verify", "unparsable"), exchange("ground", "refused", "refused"))
    )
    assert found == {"unparsable": 1, "refused": 1}


def test_boxes_that_were_all_rejected_are_of_no_use():
    rejected = exchange("ground", "", "2 boxes inverted", "1 box too small")
    assert unusable_answers(step(rejected)) == {"2 boxes inverted": 1}
    assert not unusable_answers(step(rejected, detections=[BOX]))


def test_boxes_that_were_read_out_of_a_long_answer_are_of_use():
    assert not unusable_answers(step(exchange("ground", "unparsable"), detections=[BOX]))


def test_what_is_of_use_or_not_a_models_does_not_count():
    assert not unusable_answers(
        step(exchange("ground"), exchange("choose block"), exchange("x", "refused", by_model=False))
    )
